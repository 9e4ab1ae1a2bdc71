#pragma once
#include <algorithm>
#include <cmath>

#include "compute/scene/exact.h"

namespace palpate {

/// As exact::segment_crossing, which is asked where doubles don't tell (docs/EXACTNESS.md section 9).
inline int segment_crossing(const Int3& p, const Int3& q, const exact::Corners& t) {
  double corner[3][3], way[3], most = 0, far = 0;  // relative to p, exact
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    way[k] = q[axis] - p[axis];
    far = std::max(far, std::abs(way[k]));
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c][k] = t[c][axis] - p[axis];
      most = std::max(most, std::abs(corner[c][k]));
    }
  }
  double turn[3][3];  // corner × next corner
  for (std::size_t c = 0; c < 3; ++c) {
    const double(&a)[3] = corner[c], (&b)[3] = corner[(c + 1) % 3];
    turn[c][0] = a[1] * b[2] - a[2] * b[1];
    turn[c][1] = a[2] * b[0] - a[0] * b[2];
    turn[c][2] = a[0] * b[1] - a[1] * b[0];
  }
  const auto dot = [](const double(&a)[3], const double(&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const double side[3] = {dot(turn[0], way), dot(turn[1], way), dot(turn[2], way)};
  const double slack = 0x1p-47 * most * most * far;  // 64 u M² D
  const double least = std::min({side[0], side[1], side[2]}), largest = std::max({side[0], side[1], side[2]});
  if (least < -slack && largest > slack) return 0;
  const double near_end = dot(turn[1], corner[0]), far_end = near_end - (side[0] + side[1] + side[2]);
  const double end_slack = 0x1p-47 * most * most * (most + 3 * far);
  if (std::min(near_end, far_end) > end_slack || std::max(near_end, far_end) < -end_slack) return 0;
  if (least > slack && near_end > end_slack && far_end < -end_slack) return 1;
  if (largest < -slack && near_end < -end_slack && far_end > end_slack) return -1;
  return exact::segment_crossing(p, q, t);
}

}  // namespace palpate
