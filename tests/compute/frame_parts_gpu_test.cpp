// The small parts that every shader of a frame has: poses, look-ups in a partition, numbers of workgroups.
#include <algorithm>
#include <bit>

#include "model/lattice/lattice.h"
#include "tests/compute/code.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/probe_cases.h"

namespace palpate {
namespace {

using FrameParts = GpuTest;

TEST_F(FrameParts, PosesMovePointsThereAndBack) {
  const auto cases = probe_cases::poses();
  const auto answers = run_probe<gpu::PoseAnswer>(spirv::probe_pose, cases);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& c = cases[i];
    LatticePose pose;
    pose.translation = c.translation;
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) pose.rotation_q30[r][k] = c.rotation_q30[3 * r + k];
    ASSERT_EQ(answers[i].world, transform(pose, c.point));
    const Long3 d = Long3(c.point) - Long3(c.translation);
    for (int k = 0; k < 3; ++k) {
      std::int64_t sum = std::int64_t{1} << 29;
      for (int r = 0; r < 3; ++r) sum += pose.rotation_q30[r][k] * d[r];
      ASSERT_EQ(answers[i].tool[k], static_cast<std::int32_t>(sum >> 30));
    }
  }
}

TEST_F(FrameParts, AllOutsideAGridIsExternalAndBricksAreLookedUp) {
  using namespace gpu;  // what the probe's macros name
  const auto cases = probe_cases::partitions();
  const auto answers = run_probe<PartitionAnswer>(spirv::probe_partition, cases);
  std::size_t of_class[3] = {};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& c = cases[i];
    std::uint32_t expected = kVoxelExternal, boundary = kNoVoxel;
    bool within = true;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t side = c.grid.size, voxels = 8 * c.grid.bricks[k];
      const std::int32_t off = std::clamp(c.point[k] - c.grid.origin[k], -1, voxels * side);
      ASSERT_EQ(answers[i].voxel[k], off < 0 ? -1 : off / side);
      within = within && c.voxel[k] >= 0 && c.voxel[k] < voxels;
    }
    if (within) {
      const Int3 brick = c.voxel / 8, in = c.voxel % 8;
      const auto number =
          static_cast<std::uint32_t>(brick.x + c.grid.bricks.x * (brick.y + c.grid.bricks.y * brick.z));
      const auto bit = static_cast<std::uint32_t>(in.x + 8 * in.y + 64 * in.z), word = bit / 32;
      const std::uint32_t slot = PALPATE_PROBE_SLOT(number);
      const std::uint32_t below = (1u << bit % 32) - 1;
      if (slot == kBrickInternal) {
        expected = kVoxelInternal;
      } else if (slot != kBrickExternal && (PALPATE_PROBE_BOUNDARY(slot, word) >> bit % 32 & 1u) != 0) {
        expected = kVoxelBoundary;
        boundary = PALPATE_PROBE_FIRST(slot, word) +
                   static_cast<std::uint32_t>(std::popcount(PALPATE_PROBE_BOUNDARY(slot, word) & below));
      } else if (slot != kBrickExternal && (PALPATE_PROBE_INTERNAL(slot, word) >> bit % 32 & 1u) != 0) {
        expected = kVoxelInternal;
      }
    }
    ASSERT_EQ(answers[i].voxel_class, expected);
    ASSERT_EQ(answers[i].boundary, boundary);
    ++of_class[expected];
  }
  for (const std::size_t n : of_class) EXPECT_GT(n, cases.size() / 20);
}

TEST_F(FrameParts, WorkgroupsAreSpreadOverRowsThatDevicesTake) {
  const auto cases = probe_cases::groups();
  const auto answers = run_probe<gpu::GroupsAnswer>(spirv::probe_groups, cases);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(cases[i]);
    const auto& [x, y, z] = answers[i];
    ASSERT_LE(x, gpu::kMaxGroupsX);
    ASSERT_EQ(z, 1u);
    ASSERT_GE(std::uint64_t{x} * y, cases[i]);
    ASSERT_LT(cases[i] == 0 ? 0 : std::uint64_t{x} * (y - 1), std::max(cases[i], 1u));  // no row too many
  }
}

}  // namespace
}  // namespace palpate
