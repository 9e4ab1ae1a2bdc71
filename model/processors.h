#pragma once

namespace palpate {

/// How many processors this process may use, at least 1: as many threads a batch or a preparation is worth.
/// Those of its mask (taskset, a batch system's or a container's cpuset), not all that the machine has. Asked
/// of the system at the first call, so that threads which later keep off a loop's processor count it still.
unsigned processors() noexcept;

}  // namespace palpate
