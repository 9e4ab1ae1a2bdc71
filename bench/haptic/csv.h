#pragma once
#include <string>

#include "bench/haptic/metrics.h"

namespace yardstick {

/// Every pose asked, what was felt there and what is right: a file.
void write_samples(const std::string& file, const Case& subject, const Measured& measured);

/// The heads of `figures_row`.
std::string figures_head();
std::string figures_row(const Case& subject, const std::string& method, const Measured& measured,
                        const Figures& figures);

}  // namespace yardstick
