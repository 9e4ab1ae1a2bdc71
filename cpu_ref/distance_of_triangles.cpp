// Exact by whole numbers of 640 bits: every place is a quotient whose denominator is a Gram determinant,
// nothing is rounded before the end.
#include "cpu_ref/distance_of_triangles.h"

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <optional>

#include "cpu_ref/triangle_triangle.h"

namespace palpate::cpu_ref {
namespace {

// Differences are within 2^30, determinants within 2^122, points times a determinant within 2^154, their
// squares within 2^310.
using Integer = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    640, 640, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;

Integer product(const Int3& a, const Int3& b) {
  return Integer(a.x) * b.x + Integer(a.y) * b.y + Integer(a.z) * b.z;
}

/// A point base + Σ weight · edge / den.
struct Place {
  Int3 base{0};
  std::array<Int3, 2> edges{};
  std::array<Integer, 2> weights{};
  Integer den = 1;

  Integer scaled(int k) const {
    return Integer(base[k]) * den + weights[0] * edges[0][k] + weights[1] * edges[1][k];
  }
  std::int32_t rounded(int k) const {
    const Integer twice = 2 * scaled(k) + den, under = 2 * den;
    Integer quotient = twice / under;  // towards 0
    if (quotient * under > twice) --quotient;
    return static_cast<std::int32_t>(quotient);
  }
};

/// floor of the distance: the root of the floor of the square.
std::int32_t steps_between(const Place& a, const Place& b) {
  Integer sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Integer way =
        a.scaled(k) * b.den - b.scaled(k) * a.den;  // one of the two has den 1, or both the same
    sum += way * way;
  }
  const Integer den = a.den * b.den;
  return static_cast<std::int32_t>(boost::multiprecision::sqrt(Integer(sum / (den * den))));
}

Place corner(const Int3& p) { return {.base = p}; }

/// The foot of p's perpendicular on the triangle's plane, if it lies in the closed triangle.
std::optional<Place> foot_on_face(const Int3& p, const Triangle& t) {
  const Int3 u = t[1] - t[0], v = t[2] - t[0], w = p - t[0];
  const Integer uu = product(u, u), uv = product(u, v), vv = product(v, v), uw = product(u, w),
                vw = product(v, w);
  Place out{.base = t[0],
            .edges = {u, v},
            .weights = {uw * vv - vw * uv, vw * uu - uw * uv},
            .den = uu * vv - uv * uv};
  if (out.den == 0) return std::nullopt;
  if (out.weights[0] < 0 || out.weights[1] < 0 || out.weights[0] + out.weights[1] > out.den)
    return std::nullopt;
  return out;
}

Place nearest_on_edge(const Int3& p, const Int3& a, const Int3& b) {
  Integer along = product(b - a, p - a), length = product(b - a, b - a);
  if (along < 0) along = 0;
  if (along > length) along = length;
  if (length == 0) return corner(a);
  return {.base = a, .edges = {b - a, Int3(0)}, .weights = {along, 0}, .den = length};
}

/// Where two lines come nearest, if they are not parallel and come nearest on both edges.
std::optional<std::array<Place, 2>> crossing(const Int3& a, const Int3& b, const Int3& c, const Int3& d) {
  const Int3 u = b - a, v = d - c, w = c - a;
  const Integer uu = product(u, u), uv = product(u, v), vv = product(v, v), uw = product(u, w),
                vw = product(v, w), den = uu * vv - uv * uv;
  if (den == 0) return std::nullopt;
  const Integer s = uw * vv - vw * uv, t = uw * uv - vw * uu;
  if (s < 0 || s > den || t < 0 || t > den) return std::nullopt;
  return std::array{Place{.base = a, .edges = {u, Int3(0)}, .weights = {s, 0}, .den = den},
                    Place{.base = c, .edges = {v, Int3(0)}, .weights = {t, 0}, .den = den}};
}

}  // namespace

TriangleDistance distance_of(const Triangle& s, const Triangle& m) {
  if (m.collapsed())
    for (int e = 0; e < 3; ++e)
      if (segment_meets_triangle(m[e], m[(e + 1) % 3], s)) return {};
  std::optional<TriangleDistance> best;
  const auto take = [&](const Place& on_s, const Place& on_m) {
    const std::int32_t steps = steps_between(on_s, on_m);
    if (best && steps >= best->steps) return;
    best = TriangleDistance{steps, Int3(on_s.rounded(0), on_s.rounded(1), on_s.rounded(2)),
                            Int3(on_m.rounded(0), on_m.rounded(1), on_m.rounded(2))};
  };
  // In the order of the features: corners of m, of s, then edges.
  for (int i = 0; i < 3; ++i) {
    if (const auto foot = foot_on_face(m[i], s)) take(*foot, corner(m[i]));
    for (int e = 0; e < 3; ++e) take(nearest_on_edge(m[i], s[e], s[(e + 1) % 3]), corner(m[i]));
  }
  for (int i = 0; i < 3; ++i) {
    if (const auto foot = foot_on_face(s[i], m)) take(corner(s[i]), *foot);
    for (int e = 0; e < 3; ++e) take(corner(s[i]), nearest_on_edge(s[i], m[e], m[(e + 1) % 3]));
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (const auto places = crossing(s[i], s[(i + 1) % 3], m[j], m[(j + 1) % 3]))
        take((*places)[0], (*places)[1]);
  return *best;
}

}  // namespace palpate::cpu_ref
