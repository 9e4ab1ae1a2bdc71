#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>

#include "compute/host_exact.h"

namespace palpate {

/// A way along an axis of the tool's lattice, asked which of the tool's triangles it crosses once both are moved to the world and rounded there,
/// where the tool's own frame can tell (docs/EXACTNESS.md, section 9).
class AxisWay {
 public:
  static constexpr int kUnsure = 2;   ///< exact::segment_crossing has to say
  // Between way and triangle, all roundings and the rounded matrix come to less than 2.5 steps (derived); in steps.
  static constexpr std::int32_t kMargin = 4;

  /// From `at` on. Coordinates as exact.h has them, and in the tool's lattice.
  AxisWay(const Int3& at, int axis) : axis_(axis), u_((axis + 1) % 3), v_((axis + 2) % 3), at_(at) {}
  /// The way ends at this coordinate along the axis …
  void go_to(std::int32_t end) { end_ = end; }
  /// … where the next one begins.
  void go_on() { at_[axis_] = end_; }
  /// The lattice points where it begins and ends.
  const Int3& begin() const { return at_; }
  Int3 end() const {
    Int3 out = at_;
    out[axis_] = end_;
    return out;
  }

  /// As exact::segment_crossing, or kUnsure.
  int crossing(const exact::Corners& t) const {
    // Corners from where the way begins, seen along it.
    std::int32_t u[3], v[3], z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      u[k] = t[k][u_] - at_[u_];
      v[k] = t[k][v_] - at_[v_];
      z[k] = t[k][axis_] - at_[axis_];
    }
    const std::int32_t length = end_ - at_[axis_];
    if (apart(u, 0, 0) || apart(v, 0, 0) || apart(z, std::min(length, 0), std::max(length, 0))) return 0;

    // Twice the areas that the way spans with the edges; together the triangle's: the normal's component along the axis. Within 2^60.
    std::array<std::int64_t, 3> side;
    for (std::size_t k = 0; k < 3; ++k) side[k] = std::int64_t{u[k]} * v[(k + 1) % 3] - std::int64_t{v[k]} * u[(k + 1) % 3];
    const std::int64_t area = side[0] + side[1] + side[2];
    if (area == 0) return kUnsure;
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t du = std::int64_t{u[(k + 1) % 3]} - u[k], dv = std::int64_t{v[(k + 1) % 3]} - v[k];
      const std::int64_t reach = kMargin * (std::abs(du) + std::abs(dv)), within = area > 0 ? side[k] : -side[k];   // over the edge's length: distances
      if (within < -reach) return 0;
      inside = inside && within > reach;
    }
    if (!inside) return kUnsure;
    return plane_crossing(u, v, z, side, static_cast<double>(area), length);
  }

 private:
  using Three = const std::int32_t (&)[3];
  static bool apart(Three c, std::int32_t low, std::int32_t high) {
    return std::min({c[0], c[1], c[2]}) > high + kMargin || std::max({c[0], c[1], c[2]}) < low - kMargin;
  }
  /// Of a triangle around the way's line: whether both ends are far enough from its plane, and on which side. `from` and `to` are the normal times the way from
  /// either end to the plane; the doubles are off by less than 2^-19 of the normal's size, a distance of 2^-19 steps.
  static int plane_crossing(Three u, Three v, Three z, const std::array<std::int64_t, 3>& side, double area, std::int32_t length) {
    double from = 0, across[2] = {0, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      from += static_cast<double>(side[next]) * z[k];   // a corner's weight is the area opposite to it
      across[0] += static_cast<double>(v[k]) * z[next] - static_cast<double>(z[k]) * v[next];
      across[1] += static_cast<double>(z[k]) * u[next] - static_cast<double>(u[k]) * z[next];
    }
    const double to = from - area * length, near = kMargin * (std::abs(area) + std::abs(across[0]) + std::abs(across[1]));
    if (std::abs(from) <= near || std::abs(to) <= near) return kUnsure;
    return (from > 0) == (to > 0) ? 0 : from > 0 ? 1 : -1;
  }

  int axis_, u_, v_;
  Int3 at_;
  std::int32_t end_ = 0;
};

}  // namespace palpate
