#pragma once
#include "bench/haptic/metrics.h"

namespace yardstick {

/// Prepares the adapter for the case and asks it at all its poses, the path twice: the second time counts. In
/// `rest` the hand trembles by 1 µm rms along each axis, the same for every method.
Measured measure(Adapter& adapter, const Case& subject, std::size_t rest_poses, bool cpu_clock);

}  // namespace yardstick
