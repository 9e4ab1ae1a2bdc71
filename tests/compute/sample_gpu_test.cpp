#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>

#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using Big = boost::multiprecision::cpp_int;
using Samples = GpuTest;

constexpr unsigned kEpsilonBits = 200;  // as in ray_gpu_test.cpp

/// Whether the perturbed grid point lies inside the projected triangle: three sides of the moved point, no
/// tie rules.
bool inside(const gpu::SampleCase& c, int facing) {
  const int u = (c.axis + 1) % 3, v = (c.axis + 2) % 3;
  const Big gu = (Big(c.u) << (2 * kEpsilonBits)) + (Big(1) << kEpsilonBits),
            gv = (Big(c.v) << (2 * kEpsilonBits)) + 1;
  for (int e = 0; e < 3; ++e) {
    const Int3 &p = c.corner[e], &q = c.corner[(e + 1) % 3];
    const Big side = Big(q[u] - p[u]) * (gv - (Big(p[v]) << (2 * kEpsilonBits))) -
                     Big(q[v] - p[v]) * (gu - (Big(p[u]) << (2 * kEpsilonBits)));
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
  std::vector<Long3> normals;
  const auto cases = probe_cases::samples(&normals);
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

int floor_of(std::int64_t a, std::int64_t b) {
  return static_cast<int>(a >= 0 ? a / b : -((-a + b - 1) / b));
}

TEST_F(Samples, LieInTheCellsThatIntegersSay) {
  const auto cases = probe_cases::cells();
  const auto answers = run_probe<gpu::CellAnswer>(spirv::probe_cells, cases);
  std::size_t within = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& c = cases[i];
    for (int k = 0; k < 3; ++k) {
      const int cell = std::clamp(floor_of(c.d[k], c.side), -1, c.n[k]);
      ASSERT_EQ(answers[i].along[k], cell);
      ASSERT_EQ(answers[i].last[k], floor_of(c.d[k], c.side));
      ASSERT_EQ(answers[i].first[k],
                floor_of(std::int64_t{c.d[k]} - 1, c.side));  // cells are closed: a face touches both
      if (std::int64_t{c.n.x} * c.n.y * c.n.z < std::int64_t{1} << 32) {
        ASSERT_EQ(answers[i].back[k], std::clamp(cell, 0, c.n[k] - 1));
      }
      within += cell >= 0 && cell < c.n[k] ? 1u : 0u;
    }
  }
  EXPECT_GT(within, cases.size());
}

}  // namespace
}  // namespace palpate
