#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "compute/turned_boxes.h"

namespace palpate {

/// Triangles seen along rays of one direction, eight at a time, and which rays may meet them, in doubles (docs/EXACTNESS.md, section 9). Rays are points of a
/// plane then, in squares. Coordinates are in lattice steps, relative to a lattice point near by: x and y across the rays, z along the axis of their
/// direction's largest component; x and y are sheared so that they stay along a ray.
struct RayView {
  std::array<double, 2> shear{};            ///< x and y a step along z
  double towards = 1;                       ///< 1 or −1: whether rays climb or descend along z
  double reach = 0;                         ///< no component of a triangle's corner or a ray's beginning, not sheared, is beyond it
  double least = 0;                         ///< how far ahead the rearmost ray begins: the least of towards · z
  std::array<double, 2> low{}, high{};      ///< where rays lie
  std::array<double, 2> per_step{};         ///< squares a step
  std::array<double, 2> last{};             ///< the last square, counted from 0

  /// The square of a coordinate. Monotone, so that what lies between two points is in no square beyond theirs.
  std::uint32_t square(std::size_t axis, double at) const {
    const double squares = (at - low[axis]) * per_step[axis], inside = squares < 0 ? 0 : squares;
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(inside < last[axis] ? inside : last[axis]));
  }
};

struct EightShadows {
  alignas(32) std::int32_t corner[9][kEight];   ///< coordinate k, not sheared, of corner c of triangle i is at [3 c + k][i]
  // From here on see() writes.
  alignas(32) double a[3][kEight], b[3][kEight], c[3][kEight];   ///< the side on which edge e, from corner e on, has a ray is that of a·x + b·y + c …
  alignas(32) double bound[kEight];             ///< … which is off by less than this
  alignas(32) double length[kEight];            ///< the longest side of the triangle's box
  alignas(32) std::int32_t first[2][kEight], last[2][kEight];    ///< squares, closed
  alignas(32) std::int32_t may[kEight];         ///< 0: no ray meets it
};

/// Rays by square: those of a row of squares lie one after the other.
struct RayRows {
  const double *x, *y;            ///< kRayLanes more than there are rays may be read
  const std::uint32_t* first;     ///< of each square, row by row; and one more
  std::size_t columns;
};
inline constexpr std::size_t kRayLanes = 4;

void see(const RayView& view, EightShadows& triangles);
/// Lists the rays that triangle `i` may meet, in `out` with room for kRayLanes more than there are rays; returns how many.
std::size_t rays_met(const RayView& view, const RayRows& rows, const EightShadows& triangles, std::size_t i, std::uint32_t* out);

}  // namespace palpate
