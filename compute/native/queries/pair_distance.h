#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "compute/scene/exact.h"
#include "compute/scene/triangle_tree.h"

namespace palpate::native {

inline constexpr std::size_t kLanes = 8;

/// A triangle before eight others; those by coordinate, k of corner c at [3 c + k], elsewhere: a copy costs
/// as much as a first look at them.
struct PairLanes {
  const std::array<std::array<std::int32_t, kLanes>, 9>* s;
  std::int32_t origin[3]{};  ///< the one's first corner
  double t[3][3]{};          ///< its corners relative to that

  void take(const exact::Corners& m) {
    for (int k = 0; k < 3; ++k) {
      origin[k] = m[0][k];
      for (std::size_t c = 0; c < 3; ++c) t[c][k] = m[c][k] - m[0][k];
    }
  }
};

/// Squared distances of the one to the eight, in double precision, of triangles that share no point, and the
/// features (nearest_points.h) that are so far apart. What stands for no triangle gives any number. Distances
/// are off by at most distance_error().
struct PairDistances {
  std::array<double, kLanes> squared, feature;
};
void distances(const PairLanes& lanes, PairDistances& out);

/// How the one goes on for a time: a point of it gets no further along a direction than its corners' speeds
/// along that, and `turns` besides, take it.
struct PairMotion {
  std::array<std::array<double, 3>, 3> speeds;  ///< of its corners, steps a unit of time
  double time;                                  ///< units
  double turns;  ///< steps, by which its way may turn aside in that time, in any direction
  double slack;  ///< steps, by which all of it may be elsewhere, for its pose is rounded
};
/// A bit for each of the eight that the one may meet, as far as their planes tell.
unsigned may_meet(const PairLanes& lanes, const PairMotion& motion);

/// Squares of what lies between the one and each of the eight along the two's normals: their distances are no
/// smaller, but for roundings by less than kRoomError steps.
void rooms(const PairLanes& lanes, std::array<double, kLanes>& squared);
inline constexpr double kRoomError = 0x1p-8;

/// By how many steps a distance from distances() may be off. `reach`: no coordinate difference is larger, nor
/// an edge of the two; derived in section 10 of docs/EXACTNESS.md.
inline double distance_error(double shorter_edge, double reach) {
  return shorter_edge * 0x1p-18 + reach * 0x1p-28 + 0x1p-10;
}

/// Squares of what a triangle is apart from eight boxes, along axes of their own or along its normal; no more
/// than that. Corners: k of corner c at [3 c + k].
void turned_gaps(const std::array<double, 9>& corners, const TriangleTree::TurnedBoxes& boxes,
                 std::array<double, kLanes>& squared);

struct BoxOf {  ///< a closed box, steps
  std::array<double, 3> low, high;
};
/// Squared gaps between a box and eight.
void box_gaps(const BoxOf& box, const TriangleTree::Boxes& boxes, std::array<double, kLanes>& squared);

}  // namespace palpate::native
