#include <boost/multiprecision/cpp_int.hpp>

#include "tests/compute/code.h"
#include "tests/compute/geometry_cases.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/shaders/probe_geometry.h"

namespace palpate {
namespace {

using Big = boost::multiprecision::cpp_int;
using Rays = GpuTest;
struct BigPoint {
  Big x, y, z;
};

/// ε is taken as 2^-200: smaller than any quotient of the integers here (below 2^130), so its powers decide ties as an infinitesimal would.
/// Points are scaled by ε^-3 to stay whole.
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
BigPoint cross(const BigPoint& a, const BigPoint& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Big dot(const BigPoint& a, const BigPoint& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Crossing of the perturbed ray, by the definition: the perturbed point, no tie rules.
int crossing_sign(const Int3& point, const Int3& direction, const Int3 (&corner)[3]) {
  const BigPoint p = perturbed(point), d = scaled(direction), a = scaled(corner[0]), b = scaled(corner[1]), c = scaled(corner[2]);
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
  LatticePoints points(2);
  std::vector<gpu::RayCase> cases(20000);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    points.choose();
    points.triangle(c.corner);
    c.point = points.point();
    do {
      // Towards a point of the triangle or of its plane half of the time, so that many cross, also through corners and edges.
      const Int3 at = i % 2 == 0 ? points.point() : i % 4 == 1 ? c.corner[0] : (c.corner[0] + c.corner[1]) / 2;
      c.direction = at - c.point;
      if (i % 16 == 3) c.direction = {i % 32 == 3 ? 1 << 28 : 0, 0, -(1 << 28)};
      if (i % 11 == 0) c.point = c.corner[2];
    } while (c.direction == Int3(0) && (c.point = points.point(), true));
    // The length that a direction has: largest component in [2^28, 2^29).
    while (std::max({std::abs(c.direction.x), std::abs(c.direction.y), std::abs(c.direction.z)}) < 1 << 28) c.direction *= 2;
    while (std::max({std::abs(c.direction.x), std::abs(c.direction.y), std::abs(c.direction.z)}) >= 1 << 29) c.direction /= 2;
  }
  const auto answers = run_probe<gpu::RayAnswer>(spirv::probe_ray, cases);
  std::size_t crossings = 0, along_x = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    SCOPED_TRACE(i);
    along_x += answers[i].x_sign != 0 ? 1u : 0u;
    const int expected = crossing_sign(c.point, c.direction, c.corner);
    ASSERT_EQ(answers[i].crossing_sign, expected);
    ASSERT_EQ(answers[i].x_sign, crossing_sign(c.point, {1, 0, 0}, c.corner));
    if (expected == 0) continue;
    ASSERT_EQ(Big(answers[i].height), height(c.point, c.direction, c.corner));
    ++crossings;
  }
  EXPECT_GT(crossings, cases.size() / 20);
  EXPECT_GT(along_x, cases.size() / 100);
}

TEST_F(Rays, ThroughEdgesAndCornersCrossAClosedSurfaceEvenly) {
  // An octahedron, and rays from its corners, its edges' middles and points in line with both: signs add up to 0 outside, 1 inside.
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
    int along = 0, along_x = 0;
    for (std::size_t face = 0; face < 8; ++face) {
      along += answers[i + face].crossing_sign;
      along_x += answers[i + face].x_sign;
    }
    const Int3 p = cases[i].point;
    const int norm = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
    ASSERT_EQ(along, along_x);
    ASSERT_GE(along, norm < 8 ? 1 : 0) << p.x << ' ' << p.y << ' ' << p.z;   // on the surface: either
    ASSERT_LE(along, norm > 8 ? 0 : 1) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

}  // namespace
}  // namespace palpate
