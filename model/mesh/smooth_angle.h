#pragma once
#include <cstdint>

#include "model/lattice/vector.h"
#include "model/result.h"

namespace palpate {

/// The threshold below which the angle between two normals is smooth (chapter 3.2), as a rational cos².
/// Exact for 0, 30, 45, 60 and 90 degrees; otherwise numerator / 2^30 is the nearest.
struct SmoothAngle {
  std::int64_t cos2_numerator = 3;
  std::int64_t cos2_denominator = 4;
};

/// `degrees` in [0, 90]; anything else is a bad value.
Result<SmoothAngle> make_smooth_angle(double degrees);

/// Whether the angle between raw normals n1 and n2 (components within 2^60, not 0) is below the threshold:
/// n1·n2 > 0 and (n1·n2)² · denominator > numerator · |n1|² |n2|², exactly.
bool smooth(const Long3& n1, const Long3& n2, const SmoothAngle& angle);

}  // namespace palpate
