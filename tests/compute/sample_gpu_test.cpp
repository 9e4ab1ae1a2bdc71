#include <boost/multiprecision/cpp_int.hpp>

#include "tests/compute/code.h"
#include "tests/compute/geometry_cases.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/shaders/probe_geometry.h"

namespace palpate {
namespace {

using Big = boost::multiprecision::cpp_int;
using Samples = GpuTest;

constexpr unsigned kEpsilonBits = 200;   // as in ray_gpu_test.cpp

/// Whether the perturbed grid point lies inside the projected triangle: three sides of the moved point, no tie rules.
bool inside(const gpu::SampleCase& c, int facing) {
  const int u = (c.axis + 1) % 3, v = (c.axis + 2) % 3;
  const Big gu = (Big(c.u) << (2 * kEpsilonBits)) + (Big(1) << kEpsilonBits), gv = (Big(c.v) << (2 * kEpsilonBits)) + 1;
  for (int e = 0; e < 3; ++e) {
    const Int3 &p = c.corner[e], &q = c.corner[(e + 1) % 3];
    const Big side = Big(q[u] - p[u]) * (gv - (Big(p[v]) << (2 * kEpsilonBits))) - Big(q[v] - p[v]) * (gu - (Big(p[u]) << (2 * kEpsilonBits)));
    if (side.sign() != facing) return false;
  }
  return true;
}

Big third(const gpu::SampleCase& c, const Long3& n) {
  const int u = (c.axis + 1) % 3, v = (c.axis + 2) % 3;
  Big above = Big(n[u]) * (c.u - c.corner[0][u]) + Big(n[v]) * (c.v - c.corner[0][v]), below = n[c.axis];
  above = -above;
  if (below < 0) {
    above = -above;
    below = -below;
  }
  Big q = above / below;
  if (q * below > above) q -= 1;
  return Big(c.corner[0][c.axis]) + q;
}

TEST_F(Samples, LieOnTheTriangleAsTheExactQuotientSays) {
  LatticePoints points(3);
  std::vector<gpu::SampleCase> cases(40000);
  std::vector<Long3> normals(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    auto& c = cases[i];
    points.choose();
    points.triangle(c.corner);
    const Long3 n = normals[i] = LatticePoints::normal(c.corner);
    c.axis = std::abs(n.y) > std::abs(n.x) ? 1 : 0;
    if (std::abs(n.z) > std::abs(n[c.axis])) c.axis = 2;
    const int u = (c.axis + 1) % 3, v = (c.axis + 2) % 3;
    // In the triangle's box, as the frame asks; often at a corner or on an edge.
    const auto pick = [&](int k) {
      const auto [low, high] = std::minmax({c.corner[0][k], c.corner[1][k], c.corner[2][k]});
      return i % 3 == 0 ? c.corner[i % 2][k] : low + static_cast<int>((static_cast<std::int64_t>(high) - low) * (points.within(500) + 500) / 1000);
    };
    c.u = pick(u);
    c.v = pick(v);
  }
  const auto answers = run_probe<gpu::SampleAnswer>(spirv::probe_sample, cases);
  std::size_t found = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    SCOPED_TRACE(i);
    const bool expected = inside(c, normals[i][c.axis] > 0 ? 1 : -1);
    ASSERT_EQ(answers[i].inside != 0, expected);
    if (!expected) continue;
    ++found;
    ASSERT_EQ(answers[i].point[(c.axis + 1) % 3], c.u);
    ASSERT_EQ(answers[i].point[(c.axis + 2) % 3], c.v);
    ASSERT_EQ(Big(answers[i].point[c.axis]), third(c, normals[i]));
  }
  EXPECT_GT(found, cases.size() / 10);
}

}  // namespace
}  // namespace palpate
