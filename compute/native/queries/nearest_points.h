#pragma once
#include <array>
#include <cmath>
#include <limits>

#include "model/lattice/vector.h"

namespace palpate::native {

/// Steps, world or a difference of such points.
using Vec = std::array<double, 3>;

inline Vec operator-(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec operator+(const Vec& a, const Vec& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec operator*(const Vec& a, double f) { return {a[0] * f, a[1] * f, a[2] * f}; }
inline double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec& a) { return std::sqrt(dot(a, a)); }
inline Vec vec(const Int3& p) {
  return {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
}
inline Vec vec(const Vec3& p) { return {p.x, p.y, p.z}; }

/// Two points, one on each of two triangles.
struct NearestPoints {
  double squared = std::numeric_limits<double>::infinity();
  Vec on_s{}, on_m{};
  void take(const Vec& s, const Vec& m) {
    const Vec way = m - s;
    const double d = dot(way, way);
    if (d < squared) *this = {d, s, m};
  }
};

/// Where two triangles come nearest, in doubles; neither is collapsed. Only a direction across which they are
/// apart is wanted of it: whatever that is worth is measured along it.
NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m);

/// Of which parts of two triangles the points may be: corner i of s with m's face (2 i), corner i of m with
/// s's face (2 i + 1), edge i of s with edge j of m (6 + 3 i + j).
inline constexpr std::size_t kFeatures = 15;
/// The same of one feature alone, which the two are nearest on: where that is close, a foot may lie a little
/// beside its face.
NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m, std::size_t feature);

}  // namespace palpate::native
