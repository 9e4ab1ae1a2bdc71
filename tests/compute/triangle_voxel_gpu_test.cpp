#include "compute/scene/exact.h"
#include "cpu_ref/triangle_cube.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using TriangleVoxel = GpuTest;

TEST_F(TriangleVoxel, AgreesWithClippingEdgesInFractions) {
  const auto cases = probe_cases::boxes();
  const auto answers = run_probe<std::int32_t>(spirv::probe_triangle_voxel, cases);
  int touching = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    cpu_ref::Box box;
    box.min = c.lo;
    box.max = c.hi;
    const bool want = cpu_ref::triangle_meets_box(cpu_ref::Triangle(c.a, c.b, c.c), box);
    ASSERT_EQ(answers[i] != 0, want) << "case " << i;
    const exact::Corners corners{c.a, c.b, c.c};
    ASSERT_EQ(exact::triangle_touches_cube(corners, exact::box_of(corners), c.lo, c.hi.x - c.lo.x), want)
        << "case " << i;
    touching += want;
  }
  // Both answers were asked for often enough to mean something.
  EXPECT_GT(touching, static_cast<int>(cases.size() / 10));
  EXPECT_LT(touching, static_cast<int>(cases.size() - cases.size() / 10));
}

}  // namespace
}  // namespace palpate
