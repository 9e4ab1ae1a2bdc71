#include "compute/scene/exact.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

__extension__ using I128 = __int128;
using TrianglePair = GpuTest;

int sign(I128 v) { return v < 0 ? -1 : v > 0; }

I128 dot(const Long3& n, const Int3& d) {
  return static_cast<I128>(n.x) * d.x + static_cast<I128>(n.y) * d.y + static_cast<I128>(n.z) * d.z;
}

int orientation(const Int3& a, const Int3& b, const Int3& c, const Int3& d) {
  return sign(dot(LatticePoints::cross(Long3(b) - Long3(a), Long3(c) - Long3(a)), d - a));
}

bool between(const Int3& p, const Int3& a, const Int3& b) {
  return glm::all(glm::lessThanEqual(glm::min(a, b), p)) && glm::all(glm::lessThanEqual(p, glm::max(a, b)));
}

bool on_segment(const Int3& p, const Int3& a, const Int3& b) {
  return glm::all(glm::equal(LatticePoints::cross(Long3(b) - Long3(a), Long3(p) - Long3(a)), Long3(0))) &&
         between(p, a, b);
}

/// Closed segments in one plane with normal n.
bool segments_meet(const Int3& p, const Int3& q, const Int3& a, const Int3& b, const Long3& n) {
  const auto side = [&](const Int3& u, const Int3& v, const Int3& w) {
    const Long3 m = LatticePoints::cross(Long3(v) - Long3(u), Long3(w) - Long3(u));  // parallel to n
    return sign(static_cast<I128>(m.x) * n.x + static_cast<I128>(m.y) * n.y + static_cast<I128>(m.z) * n.z);
  };
  if (on_segment(p, a, b) || on_segment(q, a, b) || on_segment(a, p, q) || on_segment(b, p, q)) return true;
  return side(p, q, a) * side(p, q, b) < 0 && side(a, b, p) * side(a, b, q) < 0;
}

bool point_in_triangle(const Int3& p, const Int3 (&t)[3], const Long3& n) {
  bool above = true;
  for (int e = 0; e < 3; ++e) {
    const Long3 m = LatticePoints::cross(Long3(t[(e + 1) % 3]) - Long3(t[e]), Long3(p) - Long3(t[e]));
    above = above && sign(static_cast<I128>(m.x) * n.x + static_cast<I128>(m.y) * n.y +
                          static_cast<I128>(m.z) * n.z) >= 0;
  }
  return above;
}

/// A closed segment and a closed triangle, case by case: the test's own way, without the shader's shortcuts.
bool segment_meets(const Int3& p, const Int3& q, const Int3 (&t)[3]) {
  const Long3 n = LatticePoints::normal(t);
  const int dp = sign(dot(n, p - t[0])), dq = sign(dot(n, q - t[0]));
  if (dp * dq > 0) return false;
  if (dp == 0 && point_in_triangle(p, t, n)) return true;
  if (dq == 0 && point_in_triangle(q, t, n)) return true;
  if (dp == 0 && dq == 0)
    return segments_meet(p, q, t[0], t[1], n) || segments_meet(p, q, t[1], t[2], n) ||
           segments_meet(p, q, t[2], t[0], n);
  if (dp == 0 || dq == 0) return false;
  const int a = orientation(p, q, t[0], t[1]), b = orientation(p, q, t[1], t[2]),
            c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool triangles_meet(const gpu::PairCase& c) {
  for (int e = 0; e < 3; ++e)
    if (segment_meets(c.s[e], c.s[(e + 1) % 3], c.t) || segment_meets(c.t[e], c.t[(e + 1) % 3], c.s))
      return true;
  return false;
}

TEST_F(TrianglePair, MeetsExactlyWhenSomeEdgeMeetsTheOtherTriangle) {
  const auto cases = probe_cases::pairs();
  const auto answers = run_probe<std::int32_t>(spirv::probe_triangle_pair, cases);
  std::size_t meeting = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const gpu::PairCase& c = cases[i];
    const exact::Corners s{c.s[0], c.s[1], c.s[2]}, t{c.t[0], c.t[1], c.t[2]};
    const bool expected = triangles_meet(c);
    ASSERT_EQ(answers[i] != 0, expected) << i;
    ASSERT_EQ(exact::triangles_meet(s, t, exact::raw_normal(t)), expected) << i;
    meeting += answers[i] != 0 ? 1u : 0u;
  }
  EXPECT_GT(meeting, cases.size() / 20);
  EXPECT_LT(meeting, cases.size() * 19 / 20);
}

}  // namespace
}  // namespace palpate
