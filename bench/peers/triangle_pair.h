#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "model/lattice/vector.h"

namespace palpate::peers {

using DoubleTriangle = std::array<Vec3, 3>;

namespace detail {

inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The interval in which a triangle crosses the line of both planes, along `axis`; `side`: its corners'
/// distances from the other plane.
inline std::array<double, 2> crossing(const DoubleTriangle& t, const std::array<double, 3>& side, int axis) {
  std::array<double, 2> out{INFINITY, -INFINITY};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const auto add = [&](double x) { out = {std::min(out[0], x), std::max(out[1], x)}; };
    if (side[i] == 0) add(t[i][axis]);
    if (side[i] * side[j] < 0) add(t[i][axis] + (t[j][axis] - t[i][axis]) * (side[i] / (side[i] - side[j])));
  }
  return out;
}

/// Two triangles of one plane, seen along `axis`: no edge's line has them on different sides.
inline bool flat_meet(const DoubleTriangle& a, const DoubleTriangle& b, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto side = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    return (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
  };
  const auto parted = [&](const DoubleTriangle& s, const DoubleTriangle& t) {
    const double turn = side(s[0], s[1], s[2]) < 0 ? -1 : 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &p = s[i], &q = s[(i + 1) % 3];
      if (turn * side(p, q, t[0]) < 0 && turn * side(p, q, t[1]) < 0 && turn * side(p, q, t[2]) < 0)
        return true;
    }
    return false;
  };
  return !parted(a, b) && !parted(b, a);
}

}  // namespace detail

/// Whether two triangles meet, in double precision: planes first, then the intervals on their common line
/// (the way of Möller 1997). What any user of a library that proposes boxes would write; not exact.
inline bool triangles_meet(const DoubleTriangle& a, const DoubleTriangle& b) {
  using namespace detail;
  const Vec3 nb = cross(b[1] - b[0], b[2] - b[0]);
  const std::array<double, 3> da{dot(nb, a[0] - b[0]), dot(nb, a[1] - b[0]), dot(nb, a[2] - b[0])};
  if ((da[0] > 0 && da[1] > 0 && da[2] > 0) || (da[0] < 0 && da[1] < 0 && da[2] < 0)) return false;
  const Vec3 na = cross(a[1] - a[0], a[2] - a[0]);
  const std::array<double, 3> db{dot(na, b[0] - a[0]), dot(na, b[1] - a[0]), dot(na, b[2] - a[0])};
  if ((db[0] > 0 && db[1] > 0 && db[2] > 0) || (db[0] < 0 && db[1] < 0 && db[2] < 0)) return false;
  const auto longest = [](const Vec3& v) {
    const double x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  };
  if (da[0] == 0 && da[1] == 0 && da[2] == 0) return flat_meet(a, b, longest(nb));
  const int axis = longest(cross(na, nb));
  const auto ia = crossing(a, da, axis), ib = crossing(b, db, axis);
  return ia[0] <= ib[1] && ib[0] <= ia[1];
}

}  // namespace palpate::peers
