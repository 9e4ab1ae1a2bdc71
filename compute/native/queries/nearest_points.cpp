#include "compute/native/queries/nearest_points.h"

#include <algorithm>

namespace palpate::native {
namespace {

/// Whether the foot of a point's perpendicular lies in the triangle.
bool above(const Vec& p, const std::array<Vec, 3>& t) {
  const Vec n = cross(t[1] - t[0], t[2] - t[0]);
  for (std::size_t e = 0; e < 3; ++e)
    if (dot(cross(n, t[(e + 1) % 3] - t[e]), p - t[e]) < 0) return false;
  return dot(n, n) > 0;
}

/// That foot, in the triangle or beside it.
Vec foot_of(const Vec& p, const std::array<Vec, 3>& t) {
  const Vec n = cross(t[1] - t[0], t[2] - t[0]);
  return p - n * (dot(n, p - t[0]) / dot(n, n));
}

}  // namespace

NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m, std::size_t feature) {
  NearestPoints out;
  if (feature < 6) {
    const std::size_t c = feature / 2;
    if (feature % 2 == 0)
      out.take(s[c], foot_of(s[c], m));
    else
      out.take(foot_of(m[c], s), m[c]);
    return out;
  }
  const std::size_t i = (feature - 6) / 3, j = (feature - 6) % 3;
  const Vec e = s[(i + 1) % 3] - s[i], f = m[(j + 1) % 3] - m[j], r = s[i] - m[j];
  const double ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), er = dot(e, r), fr = dot(f, r),
               under = ee * ff - ef * ef;
  double a = under > 0 ? std::clamp((ef * fr - er * ff) / under, 0.0, 1.0) : 0.0;
  const double b = std::clamp((ef * a + fr) / ff, 0.0, 1.0);
  a = std::clamp((ef * b - er) / ee, 0.0, 1.0);
  out.take(s[i] + e * a, m[j] + f * b);
  return out;
}

NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m) {
  NearestPoints out;
  for (std::size_t feature = 0; feature < kFeatures; ++feature) {
    if (feature < 6 && !(feature % 2 == 0 ? above(s[feature / 2], m) : above(m[feature / 2], s))) continue;
    const NearestPoints found = nearest_points(s, m, feature);
    if (found.squared < out.squared) out = found;
  }
  return out;
}

}  // namespace palpate::native
