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

/// Squared distances of the one to the eight, in double precision, of triangles that share no point. What
/// stands for no triangle gives any number. They are off by at most distance_error().
void distances(const PairLanes& lanes, std::array<double, kLanes>& squared);

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
