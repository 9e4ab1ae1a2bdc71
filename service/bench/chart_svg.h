#pragma once
#include <string>

#include "service/bench/output.h"

namespace palpate {

/// A chart of lines or a map as a picture by itself, for documents; bars are left to report.html: empty.
std::string chart_svg(const BenchChart& chart);

}  // namespace palpate
