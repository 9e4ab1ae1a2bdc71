#include "compute/host_exact.h"
#include "compute/host_heights.h"
#include "cpu_ref/direction.h"
#include "cpu_ref/heights.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using Sums = GpuTest;

TEST_F(Sums, OfNormalsAreUsableAndScaledAsTheReferences) {
  const auto cases = probe_cases::directions();
  const auto answers = run_probe<gpu::DirectionAnswer>(spirv::probe_direction, cases);
  std::size_t usable = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const Long3 sum(cases[i].sum[0], cases[i].sum[1], cases[i].sum[2]);
    ASSERT_EQ(answers[i].usable_ != 0, cpu_ref::usable(sum, cases[i].weight));
    usable += answers[i].usable_ != 0 ? 1u : 0u;
    if (sum == Long3(0)) continue;
    ASSERT_EQ(answers[i].direction, cpu_ref::normalise(sum));
    ASSERT_EQ(exact::normalise({sum.x, sum.y, sum.z}), cpu_ref::normalise(sum));
  }
  EXPECT_GT(usable, cases.size() / 4);
  EXPECT_LT(usable, cases.size() * 3 / 4);
}

TEST_F(Sums, OfHeightsAreTheReferences) {
  const auto cases = probe_cases::heights();
  const auto answers = run_probe<gpu::HeightAnswer>(spirv::probe_heights, cases);
  std::size_t faded = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& c = cases[i];
    const auto& a = answers[i];
    cpu_ref::Area area;
    cpu_ref::add_height(area, c.height, c.weight, c.point, c.fade);
    ASSERT_EQ(a.rays, area.out.rays);
    ASSERT_EQ(a.max_height, area.out.max_height);
    ASSERT_EQ(a.height, area.out.height_sum);
    ASSERT_EQ(a.weight, area.out.weight_sum);
    ASSERT_EQ(a.faded, area.out.faded_sum);
    ASSERT_EQ(a.rest, area.out.faded_rest);
    ASSERT_EQ(a.weight_slope, area.out.weight_slope);
    ASSERT_EQ(a.height_slope, area.out.height_slope);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(a.moment_low[k], area.out.moment[k].low);
      ASSERT_EQ(a.moment_high[k], area.out.moment[k].high);
    }
    gpu::AreaWork on_host{};
    HostHeights::add(on_host, c.point, c.height, c.weight, c.fade);
    ASSERT_EQ(on_host.rays, a.rays);
    ASSERT_EQ(on_host.max_height, a.max_height);
    ASSERT_EQ(on_host.height_sum, a.height);
    ASSERT_EQ(on_host.weight_sum, a.weight);
    ASSERT_EQ(on_host.faded_sum, a.faded);
    ASSERT_EQ(on_host.faded_rest, a.rest);
    ASSERT_EQ(on_host.weight_slope, a.weight_slope);
    ASSERT_EQ(on_host.height_slope, a.height_slope);
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(on_host.moment_low[k], a.moment_low[k]);
      ASSERT_EQ(on_host.moment_high[k], a.moment_high[k]);
    }
    faded += a.weight_slope != 0 ? 1u : 0u;
  }
  EXPECT_GT(faded, cases.size() / 4);
}

}  // namespace
}  // namespace palpate
