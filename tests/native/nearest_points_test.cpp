// Where two triangles come nearest, against the reference's exact distance, and whether the points named are
// points of them.
#include "compute/native/queries/nearest_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "compute/native/queries/pair_distance.h"
#include "compute/native/queries/pair_gap.h"
#include "cpu_ref/distance_of_triangles.h"
#include "cpu_ref/triangle_triangle.h"
#include "tests/equivalence/random.h"

namespace palpate::native {
namespace {

using Corners = std::array<Vec, 3>;

cpu_ref::Triangle random_triangle(equivalence::Random& random, std::int32_t size, std::int32_t far) {
  const auto point = [&](std::int32_t most) {
    return Int3{random.between(-most, most), random.between(-most, most), random.between(-most, most)};
  };
  for (;;) {  // none that is collapsed
    const Int3 at = point(far);
    const cpu_ref::Triangle out{at + point(size), at + point(size), at + point(size)};
    const Vec n = cross(vec(out[1]) - vec(out[0]), vec(out[2]) - vec(out[0]));
    if (dot(n, n) > 0) return out;
  }
}

/// `count` pairs of triangles, but for those that meet: every other one within `few` lattice points, of which
/// many are parallel, at right angles or in line, the rest as large as 2^3 to 2^most. Returns how many.
std::size_t for_pairs(
    std::uint64_t seed, int count, std::int32_t few, std::int32_t most,
    const std::function<void(const cpu_ref::Triangle&, const cpu_ref::Triangle&, std::int32_t size)>& ask) {
  equivalence::Random random(seed);
  std::size_t asked = 0;
  for (int round = 0; round < count; ++round) {
    const std::int32_t size = round % 2 == 0 ? few : 1 << random.between(3, most);
    const cpu_ref::Triangle s = random_triangle(random, size, 2 * size),
                            m = random_triangle(random, size, 2 * size);
    if (cpu_ref::triangles_intersect(s, m)) continue;
    ++asked;
    ask(s, m, size);
  }
  return asked;
}

Corners corners_of(const cpu_ref::Triangle& t) { return {vec(t[0]), vec(t[1]), vec(t[2])}; }

/// How far a point is from a triangle's plane, and by how much of the triangle's size it is beside it.
void expect_on(const Vec& p, const Corners& t, double error) {
  const Vec u = t[1] - t[0], v = t[2] - t[0], w = p - t[0], n = cross(u, v);
  EXPECT_LE(std::abs(dot(n, w)) / length(n), error);
  // Barycentric coordinates by Cramer's rule.
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v),
               all = uu * vv - uv * uv;
  const double b = (vv * wu - uv * wv) / all, c = (uu * wv - uv * wu) / all;
  const double height = length(n) / std::sqrt(std::max({uu, vv, dot(v - u, v - u)}));  // the least of three
  EXPECT_GE(std::min({b, c, 1 - b - c}), -error / height);
}

TEST(NearestPoints, AreAsFarApartAsTheReferenceSaysAndOnBoth) {
  std::size_t faces = 0;
  const auto ask = [&](const cpu_ref::Triangle& s, const cpu_ref::Triangle& m, std::int32_t size) {
    const NearestPoints found = nearest_points(corners_of(s), corners_of(m));
    // No edge is longer than 4 sizes, nothing further apart than 14; derived in EXACTNESS section 9.
    const double error = distance_error(4.0 * size, 14.0 * size), distance = std::sqrt(found.squared);
    const std::int32_t steps = cpu_ref::distance_of(s, m).steps;
    EXPECT_GE(distance, steps - error);
    EXPECT_LE(distance, steps + 1 + error);
    EXPECT_NEAR(length(found.on_m - found.on_s), distance, error);
    expect_on(found.on_s, corners_of(s), error);
    expect_on(found.on_m, corners_of(m), error);
    for (std::size_t feature = 0; feature < 6; ++feature)
      faces += nearest_points(corners_of(s), corners_of(m), feature).squared == found.squared ? 1u : 0u;
  };
  EXPECT_GT(for_pairs(3, 60'000, 3, 22, ask), 30'000u);
  EXPECT_GT(faces, 1'000u);  // most are nearest at corners and edges
}

exact::Corners lattice_corners(const cpu_ref::Triangle& t) { return {t[0], t[1], t[2]}; }

/// The same steps and the same witnesses to the last bit, whatever was known of the distance before: few
/// lattice points have halves to round in plenty, large coordinates products of 256 bits.
TEST(Gap, IsWhatTheReferenceSays) {
  const auto ask = [](const cpu_ref::Triangle& s, const cpu_ref::Triangle& m, std::int32_t) {
    const cpu_ref::TriangleDistance expected = cpu_ref::distance_of(s, m);
    const exact::Corners on_s = lattice_corners(s), on_m = lattice_corners(m);
    for (const std::int32_t most : {INT32_MAX, expected.steps + 1, expected.steps}) {
      const exact::Gap gap = exact::gap(on_s, on_m, most);
      ASSERT_EQ(gap.steps, expected.steps);
      Int3 from, to;
      exact::witnesses(on_s, on_m, gap.feature, from, to);
      ASSERT_EQ(from, expected.on_s) << "feature " << gap.feature;
      ASSERT_EQ(to, expected.on_m) << "feature " << gap.feature;
    }
    if (expected.steps > 0) {
      ASSERT_GT(exact::gap(on_s, on_m, expected.steps - 1).steps, expected.steps - 1);
    }
  };
  EXPECT_GT(for_pairs(4, 40'000, 4, 26, ask), 20'000u);
}

}  // namespace
}  // namespace palpate::native
