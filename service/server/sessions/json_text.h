#pragma once
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "model/lattice/vector.h"

namespace palpate {

/// The shortest JSON text of a number; JSON has no infinity, which becomes null.
inline std::string json_text(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

/// [x,y,z]
inline std::string json_text(const Vec3& v) {
  return fmt::format("[{},{},{}]", json_text(v.x), json_text(v.y), json_text(v.z));
}

}  // namespace palpate
