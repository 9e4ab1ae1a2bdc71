#include "cpu_ref/depth.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using Distances = GpuTest;

TEST_F(Distances, AreTheReferences) {
  const auto cases = probe_cases::distances();
  const auto answers = run_probe<gpu::DistanceAnswer>(spirv::probe_distance, cases);
  std::size_t within = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto& c = cases[i];
    LatticeMesh mesh;
    mesh.vertices.assign(std::begin(c.corner), std::end(c.corner));
    mesh.triangles = {{0, 1, 2}};
    mesh.unit_normal_q30 = {c.normal};
    const std::uint32_t expected = cpu_ref::distance(mesh, 0, c.point);
    ASSERT_EQ(static_cast<std::uint32_t>(answers[i].steps), expected) << "case " << i;
    // Bounds allow for how far the definition may be off the true distance: 16 steps below, 32 for another
    // triangle that is judged by them.
    ASSERT_LE(answers[i].least, answers[i].steps + 16) << "case " << i;
    ASSERT_GE(answers[i].most, answers[i].steps + 16) << "case " << i;
    within += expected < 200 ? 1u : 0u;
  }
  EXPECT_GT(within, cases.size() / 5);
  EXPECT_LT(within, cases.size() / 5 * 4);
}

}  // namespace
}  // namespace palpate
