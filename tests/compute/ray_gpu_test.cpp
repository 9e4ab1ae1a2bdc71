#include <boost/multiprecision/cpp_int.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "compute/scene/exact.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using Big = boost::multiprecision::cpp_int;
using Rays = GpuTest;
struct BigPoint {
  Big x, y, z;
};

/// ε is taken as 2^-200: smaller than any quotient of the integers here (below 2^130), so its powers decide
/// ties as an infinitesimal would. Points are scaled by ε^-3 to stay whole.
constexpr unsigned kEpsilonBits = 200;

BigPoint scaled(const Int3& p) {
  return {Big(p.x) << (3 * kEpsilonBits), Big(p.y) << (3 * kEpsilonBits), Big(p.z) << (3 * kEpsilonBits)};
}
BigPoint perturbed(const Int3& p) {
  BigPoint out = scaled(p);
  out.x += Big(1) << (2 * kEpsilonBits);
  out.y += Big(1) << kEpsilonBits;
  out.z += 1;
  return out;
}
BigPoint minus(const BigPoint& a, const BigPoint& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
BigPoint cross(const BigPoint& a, const BigPoint& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Big dot(const BigPoint& a, const BigPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Crossing of the perturbed ray, by the definition: the perturbed point, no tie rules.
int crossing_sign(const Int3& point, const Int3& direction, const Int3 (&corner)[3]) {
  const BigPoint p = perturbed(point), d = scaled(direction), a = scaled(corner[0]), b = scaled(corner[1]),
                 c = scaled(corner[2]);
  const BigPoint n = cross(minus(b, a), minus(c, a));
  const int facing = dot(d, n).sign();
  if (facing == 0) return 0;
  for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
    if (dot(d, cross(minus(u, p), minus(v, p))).sign() != facing) return 0;
  return dot(minus(a, p), n).sign() == facing ? facing : 0;
}

Big height(const Int3& point, const Int3& direction, const Int3 (&corner)[3]) {
  const BigPoint p = scaled(point), d = scaled(direction), a = scaled(corner[0]);
  const BigPoint n = cross(minus(scaled(corner[1]), a), minus(scaled(corner[2]), a));
  const Big above = dot(minus(a, p), n) << 30, below = dot(d, n);
  Big q = above / below;
  const Big rest = above - q * below;
  if (rest.sign() * below.sign() < 0) q -= 1;
  return q;
}

TEST_F(Rays, CrossWhereThePerturbedRayDoes) {
  const auto cases = probe_cases::rays();
  const auto answers = run_probe<gpu::RayAnswer>(spirv::probe_ray, cases);
  std::size_t crossings = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    SCOPED_TRACE(i);
    const int expected = crossing_sign(c.point, c.direction, c.corner);
    ASSERT_EQ(answers[i].crossing_sign, expected);
    ASSERT_EQ(answers[i].culled, 0);  // a cheap test that lets go what is crossed
    if (expected == 0) continue;
    ASSERT_EQ(Big(answers[i].height), height(c.point, c.direction, c.corner));
    ++crossings;
  }
  EXPECT_GT(crossings, cases.size() / 20);
}

TEST_F(Rays, ThroughEdgesAndCornersCrossAClosedSurfaceEvenly) {
  // An octahedron, and rays from its corners, its edges' middles and points in line with both: signs add up
  // to 0 outside, 1 inside.
  const Int3 ends[6] = {{8, 0, 0}, {-8, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 8}, {0, 0, -8}};
  std::vector<gpu::RayCase> cases;
  constexpr int kReach = 10;
  for (int x = -kReach; x <= kReach; x += 2)
    for (int y = -kReach; y <= kReach; y += 2)
      for (int z = -kReach; z <= kReach; z += 2)
        for (int face = 0; face < 8; ++face) {
          gpu::RayCase c{};
          c.point = {x, y, z};
          c.direction = {1 << 28, 0, 0};
          const int i = face & 1, j = 2 + (face >> 1 & 1), k = 4 + (face >> 2);
          const bool even = (i + (j - 2) + (k - 4)) % 2 == 0;
          c.corner[0] = ends[i];
          c.corner[1] = ends[even ? j : k];
          c.corner[2] = ends[even ? k : j];
          cases.push_back(c);
        }
  const auto answers = run_probe<gpu::RayAnswer>(spirv::probe_ray, cases);
  for (std::size_t i = 0; i < cases.size(); i += 8) {
    int along = 0;
    for (std::size_t face = 0; face < 8; ++face) along += answers[i + face].crossing_sign;
    const Int3 p = cases[i].point;
    const int norm = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
    ASSERT_GE(along, norm < 8 ? 1 : 0) << p.x << ' ' << p.y << ' ' << p.z;  // on the surface: either
    ASSERT_LE(along, norm > 8 ? 0 : 1) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

/// Crossing of the segment whose ends are moved alike, by the definition.
int segment_sign(const gpu::RayCase& c) {
  const BigPoint p = perturbed(c.point), q = perturbed(c.direction), a = scaled(c.corner[0]),
                 b = scaled(c.corner[1]), d = minus(q, p);
  const BigPoint n = cross(minus(b, a), minus(scaled(c.corner[2]), a));
  const int facing = dot(minus(a, p), n).sign();
  if (dot(minus(a, q), n).sign() == facing) return 0;
  for (int e = 0; e < 3; ++e)
    if (dot(d, cross(minus(scaled(c.corner[e]), p), minus(scaled(c.corner[(e + 1) % 3]), p))).sign() !=
        facing)
      return 0;
  return facing;
}

TEST_F(Rays, SegmentsCrossWhereTheirPerturbedEndsSay) {
  const auto cases = probe_cases::segments();
  const auto answers = run_probe<gpu::SegmentAnswer>(spirv::probe_segment, cases);
  constexpr int kUnsure = 2;  // of lib/segment_estimate.glsl
  std::size_t crossings = 0, sure = 0, sure_crossings = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const int sign = segment_sign(cases[i]);
    ASSERT_EQ(answers[i].crossing, sign);
    if (answers[i].estimate != kUnsure) {
      ASSERT_EQ(answers[i].estimate, sign);
      ++sure;
      sure_crossings += sign != 0 ? 1u : 0u;
    }
    ASSERT_EQ(exact::segment_crossing(cases[i].point, cases[i].direction,
                                      {cases[i].corner[0], cases[i].corner[1], cases[i].corner[2]}),
              sign);
    crossings += sign != 0 ? 1u : 0u;
  }
  EXPECT_GT(crossings, cases.size() / 50);
  EXPECT_GT(sure, cases.size() / 2);
  EXPECT_GT(sure_crossings, crossings / 4);
}

}  // namespace
}  // namespace palpate
