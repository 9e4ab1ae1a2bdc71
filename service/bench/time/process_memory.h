#pragma once
#include <cstdint>

namespace palpate {

/// From now on peak_memory() tells of what follows. Nothing happens where the system has no such thing.
void restart_peak_memory();

/// The most memory of this process that was resident at a time, bytes; 0: unknown.
std::uint64_t peak_memory();

}  // namespace palpate
