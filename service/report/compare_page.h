#pragma once
#include <string>

#include "service/report/run_difference.h"

namespace palpate {

/// Two runs as one self-contained page: force and torque over each other, their difference, and the figures
/// in which they differ.
std::string compare_page(const RecordedRun& first, const RecordedRun& second,
                         const RunDifference& difference);

/// "0.012 N at 3.214 s, root mean square 0.001 N, from 1.2 s on"; "the same".
std::string difference_text(const RunDifference& difference, const TickDifference& quantity);

}  // namespace palpate
