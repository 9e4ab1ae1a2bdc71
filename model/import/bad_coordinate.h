#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "model/lattice/lattice_build.h"

namespace palpate {

/// What is wrong with a coordinate, m, as the rest of a sentence that begins with the file's name, or
/// nothing. `where`: "vertex 2 of 'lid'". Places and units may make of an infinite coordinate none at all.
inline std::string bad_coordinate(double metres, const std::string& where) {
  return fmt::format("has coordinate {} in {}, which is not a number within ±{} m",
                     std::isfinite(metres) ? fmt::format("{} m", metres) : "inf or nan", where,
                     kLargestCoordinate);
}

}  // namespace palpate
