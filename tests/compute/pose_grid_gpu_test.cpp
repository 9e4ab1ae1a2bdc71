// One submission answers many poses, as a lone frame answers each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compute/gpu/frame/frame.h"
#include "compute/gpu/frame/pose_grid.h"
#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "tests/compute/subject.h"
#include "tests/equivalence/contacts_difference.h"

namespace palpate {
namespace {

/// A grid of poses, and a lone frame beside it, on a device that looks on.
class Grid {
 public:
  explicit Grid(const Subject& of, const std::map<std::string, std::uint32_t>& first_capacity = {},
                bool own_memory = false) {
    GpuOptions options;
    options.validation = options.guard_buffers = true;
    options.own_memory = own_memory;
    device = taken(VulkanDevice::create(options));
    scene = taken(prepare_scene(*device, of.geometry, Plan{}, {}));
    frame = taken(Frame::create(*device, of.geometry, *scene, {}, Plan{}));
    grid = taken(PoseGrid::create(*device, of.geometry, *scene, first_capacity, Plan{}));
  }
  Result<void> ask(std::span<const LatticePose> poses) {
    answers.resize(std::max(answers.size(), poses.size()));
    std::vector<GridPose> asked;
    for (std::size_t i = 0; i < poses.size(); ++i) asked.push_back({poses[i], 0, &answers[i]});
    if (auto done = grid->ask(asked); !done) return done;
    return device->check_guards();
  }

  std::unique_ptr<VulkanDevice> device;
  std::optional<PreparedScene> scene;
  std::unique_ptr<Frame> frame;
  std::unique_ptr<PoseGrid> grid;
  std::vector<Contacts> answers;
};

TEST(PoseGrid, ASubmissionHasTheSameDispatchesHoweverManyPoses) {
  const Subject scene = subject("disassembly", 4000, 300);
  Grid on(scene);
  ASSERT_LT(on.grid->most(), scene.poses.size());
  for (int times = 0; times < 3; ++times)  // lists grow
    ASSERT_TRUE(on.ask(std::span<const LatticePose>(scene.poses).last(on.grid->most())));
  DeviceWork one;
  std::size_t all = 0;
  for (const std::size_t size : {std::size_t{1}, std::size_t{2}, std::size_t{63}, std::size_t{64},
                                 std::size_t{65}, on.grid->most() - 1, on.grid->most()}) {
    SCOPED_TRACE(size);
    const std::span poses = std::span<const LatticePose>(scene.poses).last(size);
    const DeviceWork before = on.grid->work();
    ASSERT_TRUE(on.ask(poses));
    const DeviceWork after = on.grid->work();
    EXPECT_EQ(after.submissions - before.submissions, 1u);
    EXPECT_LE(after.dispatches - before.dispatches, 10u);
    EXPECT_LE(after.barriers - before.barriers, 8u);
    if (size == 1)
      one = {.dispatches = after.dispatches - before.dispatches,
             .barriers = after.barriers - before.barriers};
    EXPECT_EQ(after.dispatches - before.dispatches, one.dispatches);
    EXPECT_EQ(after.barriers - before.barriers, one.barriers);
    Contacts single;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < size; ++i) {
      ASSERT_TRUE(on.frame->query(poses[i], nullptr, single));
      EXPECT_EQ(first_difference(on.answers[i], single), "") << i;
      contacts += single.contact ? 1u : 0u;
    }
    all += contacts;
  }
  EXPECT_GT(all, 100u);
}

TEST(PoseGrid, APosesOwnCoarsenessCountsAndAPoseBeyondTheLatticeIsFree) {
  const Subject scene = subject("contacts", 8000, 60);
  Grid on(scene);
  std::vector<Contacts> answers(scene.poses.size());
  std::vector<GridPose> asked;
  for (std::size_t i = 0; i < answers.size(); ++i)
    asked.push_back(
        {scene.poses[i], static_cast<std::uint32_t>(61 * i % (Ignored::kCoarsest + 1)), &answers[i]});
  asked[7].pose.beyond_lattice = true;
  ASSERT_TRUE(on.grid->ask(asked));
  Contacts single;
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    Ignored coarser;
    coarser.coarser = asked[i].coarser;
    ASSERT_TRUE(on.frame->query(asked[i].pose, &coarser, single));
    EXPECT_EQ(first_difference(answers[i], single), "") << i;
    contacts += single.contact ? 1u : 0u;
  }
  EXPECT_GT(contacts, 20u);
  EXPECT_FALSE(answers[7].contact);
}

TEST(PoseGrid, WhetherPosesTouchIsTheirFramesContact) {
  const Subject scene = subject("disassembly", 4000, 300);
  std::vector<LatticePose> poses = scene.poses;
  poses[7].beyond_lattice = true;
  for (const bool small : {false, true}) {
    SCOPED_TRACE(small);
    Grid on(scene, small ? std::map<std::string, std::uint32_t>{{"lists of touched voxels", 40}}
                         : std::map<std::string, std::uint32_t>{});
    std::size_t contacts = 0, open = 0, free = 0;
    Contacts single;
    for (std::size_t first = 0; first < poses.size(); first += on.grid->most()) {
      const auto some =
          std::span<const LatticePose>(poses).subspan(first, std::min(on.grid->most(), poses.size() - first));
      std::vector<std::uint8_t> bits(some.size(), 7);
      const DeviceWork before = on.grid->work();
      ASSERT_TRUE(on.grid->touch(some, bits));
      ASSERT_TRUE(on.device->check_guards());
      const DeviceWork after = on.grid->work();
      EXPECT_EQ(after.submissions - before.submissions, 1u);
      EXPECT_EQ(after.dispatches - before.dispatches, 6u);
      for (std::size_t i = 0; i < some.size(); ++i) {
        ASSERT_TRUE(on.frame->query(some[i], nullptr, single));
        open += bits[i] == PoseGrid::kOpen ? 1u : 0u;
        if (bits[i] != PoseGrid::kOpen) {
          EXPECT_EQ(bits[i], single.contact ? 1 : 0) << first + i;
        }
        contacts += single.contact ? 1u : 0u;
        free += single.contact ? 0u : 1u;
      }
      // Forces after touches, and the other way round, on the same tables.
      ASSERT_TRUE(on.ask(some));
      for (std::size_t i = 0; i < some.size(); ++i)
        if (!on.answers[i].truncated && bits[i] != PoseGrid::kOpen) {
          EXPECT_EQ(on.answers[i].contact, bits[i] == 1);
        }
    }
    EXPECT_GT(contacts, 90u);
    EXPECT_GT(free, 20u);
    EXPECT_LT(open, poses.size() / 2);
    EXPECT_TRUE(open > 0 || !small);
  }
}

// Each list far too small for all: what there was no room for is flagged and the rest is right; room grows
// until all is.
TEST(PoseGrid, WhatAListHasNoRoomForIsFlaggedPoseByPoseAndNothingElse) {
  const Subject scene = subject("disassembly", 4000, 60);
  Grid reference(scene);
  std::vector<Contacts> singles(scene.poses.size());
  for (std::size_t i = 0; i < singles.size(); ++i)
    ASSERT_TRUE(reference.frame->query(scene.poses[i], nullptr, singles[i]));
  for (const char* list :
       {"near parts of the tool", "touched voxels", "lists of touched voxels", "pairs to test",
        "contact triangles of the mock-up", "contact triangles of the tool", "lists with samples",
        "samples near the tool's surface", "samples", "samples that weigh something", "tiles of tool samples",
        "samples of the tool"}) {
    SCOPED_TRACE(list);
    Grid on(scene, {{list, 40}});
    std::size_t flagged = 1, most_flagged = 0, least_flagged = singles.size();
    for (int round = 0; flagged > 0; ++round) {
      ASSERT_LT(round, 20);
      ASSERT_TRUE(on.ask(scene.poses));
      flagged = 0;
      for (std::size_t i = 0; i < singles.size(); ++i) {
        flagged += on.answers[i].truncated ? 1u : 0u;
        if (on.answers[i].truncated) {
          EXPECT_TRUE(on.answers[i].field.max_depth == 0 && on.answers[i].areas.empty()) << "no force";
        } else {
          EXPECT_EQ(first_difference(on.answers[i], singles[i]), "") << "round " << round << ", pose " << i;
        }
      }
      most_flagged = std::max(most_flagged, flagged);
      if (round == 0) least_flagged = flagged;
    }
    EXPECT_GT(most_flagged, 0u);
    EXPECT_LT(least_flagged, singles.size()) << "all were flagged for what some asked";
  }
}

// One pose of all is more than there is room for.
TEST(PoseGrid, AnOverflowOfOnePoseFlagsThisPose) {
  const Subject scene = subject("disassembly", 4000, 200);
  const char* const list = "contact triangles of the mock-up";
  Grid on(scene, {{list, 1}});
  Contacts single;
  std::vector<LatticePose> poses;
  std::optional<LatticePose> deep;
  for (const LatticePose& pose : scene.poses) {
    ASSERT_TRUE(on.frame->query(pose, nullptr, single));
    const std::size_t statics = single.cst.size() + single.bst.size() + single.est.size();
    if (statics == 0)
      poses.push_back(pose);
    else if (statics > 3)
      deep = pose;
  }
  ASSERT_TRUE(deep && poses.size() > 50);
  poses.insert(poses.begin() + 30, *deep);
  ASSERT_TRUE(on.ask(poses));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(on.answers[i].truncated, i == 30) << i;
    ASSERT_TRUE(on.frame->query(poses[i], nullptr, single));
    if (i != 30) {
      EXPECT_EQ(first_difference(on.answers[i], single), "") << i;
    }
  }
  EXPECT_STREQ(on.answers[30].truncated_capacity, list);
}

// Keys hang on a pose's place in its batch: whatever one left in a table would fill it before long.
TEST(PoseGrid, WhatABatchLeavesInTablesIsNothing) {
  const Subject scene = subject("disassembly", 4000, 120);
  Grid on(scene, {{"contact triangles of the mock-up", 1},
                  {"contact triangles of the tool", 1},
                  {"touched voxels", 1},
                  {"pairs to test", 1}});
  constexpr std::size_t kAtOnce = 40;
  const auto flagged = [&](std::size_t first) {
    EXPECT_TRUE(on.ask(std::span<const LatticePose>(scene.poses).subspan(first, kAtOnce)));
    return std::count_if(on.answers.begin(), on.answers.begin() + kAtOnce,
                         [](const Contacts& answer) { return answer.truncated; });
  };
  for (const bool grown : {false, true})  // lists grow to what any of these batches takes
    for (std::size_t first = 0; first + kAtOnce <= scene.poses.size(); first += 4) {
      auto left = flagged(first);
      for (int round = 0; !grown && left > 0 && round < 20; ++round) left = flagged(first);
      EXPECT_EQ(left, 0) << "from pose " << first;
    }
}

TEST(PoseGrid, ADeviceThatIsLostAnswersNothing) {
  const Subject scene = subject("disassembly", 4000, 100);
  const auto fault = std::make_shared<GpuFault>();
  GpuOptions options;
  options.fault = fault;
  const auto device = taken(VulkanDevice::create(options));
  const PreparedScene prepared_here = taken(prepare_scene(*device, scene.geometry, Plan{}, {}));
  const auto grid = taken(PoseGrid::create(*device, scene.geometry, prepared_here, {}, Plan{}));
  std::vector<Contacts> answers(scene.poses.size());
  std::vector<GridPose> asked;
  for (std::size_t i = 0; i < answers.size(); ++i) asked.push_back({scene.poses[i], 0, &answers[i]});
  ASSERT_TRUE(grid->ask(asked));
  fault->after = 0;
  fault->call = GpuFault::Call::kSubmit;
  const auto lost = grid->ask(asked);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().sentence.find("the device was lost"), std::string::npos) << lost.error().sentence;
  for (const Contacts& answer : answers) EXPECT_FALSE(answer.contact) << "an answer of the batch before";
}

}  // namespace
}  // namespace palpate
