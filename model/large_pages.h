#pragma once
#include <cstddef>
#include <cstdint>

namespace palpate {

inline constexpr std::size_t kLargePage = std::size_t{2} << 20;   ///< bytes; memory that begins at a multiple of it is covered best

/// Asks the system to back memory by large pages where it has them: 2 MiB are then had, and given back, at once and not in 512 faults. For memory that is
/// about to be filled wholly; contents stay. Where less than two such pages lie in it, or the system has none, nothing happens.
void want_large_pages(void* data, std::size_t bytes);

}  // namespace palpate
