#pragma once
#include <cstdint>
#include <optional>

namespace palpate {

/// Bytes of address space that this process may still take (RLIMIT_AS, `ulimit -v`), or nothing when it has
/// no limit. Drivers do not look whether their allocations succeed: lavapipe ends in a segmentation fault, so
/// it must not come to that.
std::optional<std::uint64_t> address_space_left();

/// What must be left for a driver to start, compile shaders and run. Measured on Mesa 22.3's lavapipe: 450 MB
/// is too little, 600 MB enough; chosen with room to spare.
inline constexpr std::uint64_t kDriverAddressSpace = std::uint64_t{1} << 30;

}  // namespace palpate
