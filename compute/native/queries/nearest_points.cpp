#include "compute/native/queries/nearest_points.h"

#include <algorithm>

namespace palpate::native {

NearestPoints nearest_points(const std::array<Vec, 3>& s, const std::array<Vec, 3>& m) {
  NearestPoints out;
  const auto above = [&](const Vec& p, const std::array<Vec, 3>& t, bool of_m) {
    const Vec n = cross(t[1] - t[0], t[2] - t[0]);
    const double size = dot(n, n);
    if (!(size > 0)) return;
    for (std::size_t e = 0; e < 3; ++e)
      if (dot(cross(n, t[(e + 1) % 3] - t[e]), p - t[e]) < 0) return;
    const Vec foot = p - n * (dot(n, p - t[0]) / size);
    if (of_m)
      out.take(foot, p);
    else
      out.take(p, foot);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    above(m[c], s, true);
    above(s[c], m, false);
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec e = s[(i + 1) % 3] - s[i], f = m[(j + 1) % 3] - m[j], r = s[i] - m[j];
      const double ee = dot(e, e), ff = dot(f, f), ef = dot(e, f), er = dot(e, r), fr = dot(f, r),
                   under = ee * ff - ef * ef;
      double a = under > 0 ? std::clamp((ef * fr - er * ff) / under, 0.0, 1.0) : 0.0;
      const double b = std::clamp((ef * a + fr) / ff, 0.0, 1.0);
      a = std::clamp((ef * b - er) / ee, 0.0, 1.0);
      out.take(s[i] + e * a, m[j] + f * b);
    }
  return out;
}

}  // namespace palpate::native
