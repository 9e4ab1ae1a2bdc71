#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "model/lattice/lattice_build.h"

namespace palpate {

/// What is wrong with a coordinate, m, that is not within ±kLargestCoordinate, as the rest of a sentence that
/// begins with the file's name. `where`: "vertex 2 of 'lid'". Of an infinite one places and units may have
/// made none at all.
inline std::string bad_coordinate(double metres, const std::string& where) {
  return fmt::format("has coordinate {} in {}, which is not a number within ±{} m",
                     std::isfinite(metres) ? fmt::format("{} m", metres) : "inf or nan", where,
                     kLargestCoordinate);
}

}  // namespace palpate
