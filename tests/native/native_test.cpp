// What the native engine promises beside its bits, which tests/equivalence holds against the other engines'.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "compute/native/native_backend.h"
#include "compute/native/prepare/scene.h"
#include "compute/scene/samples.h"
#include "cpu_ref/ref_backend.h"
#include "model/generate.h"
#include "model/generate/solids.h"
#include "model/processors.h"
#include "model/scene/geometry_build.h"
#include "tests/driver/allocation_count.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/equivalence/lattice_shapes.h"

namespace palpate {
namespace {

SceneGeometry built(const Mesh& mockup, const Mesh& tool) {
  auto geometry = build_geometry(mockup, tool, {});
  EXPECT_TRUE(geometry) << geometry.error().sentence;
  return std::move(*geometry);
}

LatticePose at(const SceneGeometry& geometry, const Vec3& position, const Quat& rotation = Quat(1, 0, 0, 0)) {
  return *to_lattice(Pose{position, rotation}, geometry);
}

/// Two boards, a face of each of 7,200 triangles towards the other.
SceneGeometry pressed_boards() {
  return built(solids::box(Vec3(-0.06, -0.06, -0.01), Vec3(0.06, 0.06, 0), Int3(60, 60, 5)),
               solids::box(Vec3(-0.06, -0.06, 0), Vec3(0.06, 0.06, 0.01), Int3(60, 60, 5)));
}

TEST(Native, MakesRoomForAContactLargerThanAllBeforeWithinTheQuery) {
  const SceneGeometry geometry = pressed_boards();
  const auto native = make_native_backend(), ref = make_ref_backend();
  ASSERT_TRUE(native->prepare(geometry, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(geometry, Plan{}, {}));
  const LatticePose pose =
      at(geometry, Vec3(0.0003, 0.0002, 0));  // faces in one plane: every triangle meets several
  Contacts found, expected;
  ASSERT_TRUE(native->query(pose, nullptr, found));
  ASSERT_TRUE(ref->query(pose, nullptr, expected));
  EXPECT_FALSE(found.truncated);
  EXPECT_GT(found.pairs, std::uint64_t{1} << 14) << "no more than a list has room for to begin with";
  EXPECT_EQ(first_difference(found, expected), "");
}

TEST(Native, AllocatesNothingInAFrameOnceItHasSeenOneLikeIt) {
  const SceneGeometry geometry = pressed_boards();
  const auto native = make_native_backend();
  Plan plan;
  plan.telemetry = false;  // as for a loop that nobody watches
  ASSERT_TRUE(native->prepare(geometry, plan, {}));
  Contacts out;
  const auto ask = [&](int i) {
    return static_cast<bool>(
        native->query(at(geometry, Vec3(0.0001 * i, 0.0002, -0.0005 - 0.0001 * (i % 5))), nullptr, out));
  };
  // Which of the frame's threads has how much of it is chance, and each has room of its own: after a few
  // rounds both have had as much as there is.
  std::size_t allocated = 1;
  for (int round = 0; round < 20 && allocated != 0; ++round) {
    const std::size_t before = allocations_of_this_thread();
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(ask(i));
    allocated = allocations_of_this_thread() - before;
  }
  EXPECT_EQ(allocated, 0u);
  EXPECT_TRUE(out.contact);
}

/// Of samples it keeps as many as 48 MiB hold; of a tool with more they are worked out at each pose.
TEST(Native, AnswersOfAToolWithMoreSamplesThanItKeeps) {
  const auto scene = equivalence::lattice_scene(equivalence::box_of(Int3(0, 0, -3000), Int3(2000, 1500, 0)),
                                                equivalence::box_of(Int3(0), Int3(12000, 12000, 40)), 504, 8);
  ASSERT_TRUE(scene) << scene.error().sentence;
  ASSERT_GT(scene->tool_surface.area / (8 * 8), 1 << 22);
  const auto native = make_native_backend(), ref = make_ref_backend();
  ASSERT_TRUE(native->prepare(*scene, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(*scene, Plan{}, {}));
  const LatticePose pose = at(*scene, Vec3(-5003, -4007, -11), glm::angleAxis(0.001, Vec3(0.6, 0.8, 0)));
  Contacts found, expected;
  ASSERT_TRUE(native->query(pose, nullptr, found));
  ASSERT_TRUE(ref->query(pose, nullptr, expected));
  std::uint32_t pushes = 0;
  for (const FieldBin& bin : found.field.bins) pushes += bin.samples;
  EXPECT_GT(pushes, 1000u);
  EXPECT_EQ(first_difference(found, expected), "");
}

/// What of a tool lies deep inside is taken by whole runs of triangles, but for needles, which at some poses
/// are collinear, when they touch nothing.
TEST(Native, AnswersOfAToolDeepInside) {
  equivalence::Triangles tool;
  for (int i = 0; i < 64; ++i) {
    const Int3 low = 2500 * (Int3(i & 3, i >> 2 & 3, i >> 4) - 2);
    append(tool, equivalence::box_of(low, low + 400 + 10 * i));
    if (i % 8 != 0) continue;
    const Int3 a = low + 1000, b = a + Int3(100, 0, 0), c = a + Int3(200, 1, 0);
    append(tool, {{a, b, c}, {a, c, b}});
  }
  const auto scene =
      equivalence::lattice_scene(equivalence::box_of(Int3(-20000), Int3(20000)), tool, 504, 126);
  ASSERT_TRUE(scene) << scene.error().sentence;
  const auto native = make_native_backend(), ref = make_ref_backend();
  ASSERT_TRUE(native->prepare(*scene, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(*scene, Plan{}, {}));
  std::size_t wholly = 0, collinear = 0, partly = 0;
  for (int i = 0; i < 40; ++i) {
    const Vec3 axis = glm::normalize(Vec3(std::sin(i), std::cos(2 * i), std::sin(3 * i)));
    const LatticePose pose =
        at(*scene, Vec3(100 * i, (i % 4 == 0 ? 440 : 11) * i, -9 * i), glm::angleAxis(0.37 * i, axis));
    Contacts found, expected;
    ASSERT_TRUE(native->query(pose, nullptr, found));
    ASSERT_TRUE(ref->query(pose, nullptr, expected));
    EXPECT_EQ(first_difference(found, expected), "") << i;
    if (!expected.cmt.empty() || !expected.bmt.empty()) {
      ++partly;
      continue;
    }
    EXPECT_LE(expected.imt.size(), tool.size());
    (expected.imt.size() == tool.size() ? wholly : collinear) += 1;
    EXPECT_LT(found.times.front().looks, tool.size() / 2) << found.times.front().stage;
  }
  EXPECT_GT(wholly, 0u);
  EXPECT_GT(collinear, 0u);
  EXPECT_GT(partly, 0u);
}

/// A voxel that lists more triangles than its samples' places can tell apart: none is listed then, and what
/// lies in the tool is looked for triangle by triangle.
TEST(Native, AnswersWhereAVoxelListsMoreThanItsSamplesCanTellApart) {
  GeometrySettings settings;
  settings.voxel_size_m = 0.02;
  settings.sample_spacing_m = 0.001;
  const auto geometry =
      build_geometry(solids::box(Vec3(0), Vec3(0.009, 0.009, 0.005), Int3(380, 380, 1)),
                     solids::box(Vec3(-0.004), Vec3(0.004, 0.004, 0.03), Int3(2, 2, 2)), settings);
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  const auto native = make_native_backend(), ref = make_ref_backend();
  ASSERT_TRUE(native->prepare(*geometry, Plan{}, {}));
  ASSERT_TRUE(ref->prepare(*geometry, Plan{}, {}));
  const auto partition = native->partition(false);
  ASSERT_TRUE(partition);
  std::uint64_t longest = 0;
  for (std::size_t i = 1; i < partition->list_begin.size(); ++i)
    longest = std::max(longest, partition->list_begin[i] - partition->list_begin[i - 1]);
  ASSERT_GT(longest, VoxelSamples::kLongestList);
  Contacts found, expected;
  // In the middle, where its voxels meet.
  const LatticePose pose = at(*geometry, Vec3(0.004, 0.005, 0.0085), glm::angleAxis(0.2, Vec3(0.6, 0.8, 0)));
  ASSERT_TRUE(native->query(pose, nullptr, found));
  ASSERT_TRUE(ref->query(pose, nullptr, expected));
  EXPECT_TRUE(found.contact);
  EXPECT_EQ(first_difference(found, expected), "");
}

/// A plate's two faces have far more samples than triangles; a ball's triangles are about as large as voxels.
TEST(Native, ForetellsWhatListsOfSamplesTake) {
  for (const Mesh& mockup : {solids::box(Vec3(0), Vec3(0.3, 0.3, 0.01)), solids::sphere_of(0.1, 20'000)})
    for (const double voxel : {0.001, 0.004}) {
      GeometrySettings settings;
      settings.voxel_size_m = voxel;
      const auto geometry = build_geometry(mockup, solids::box(Vec3(0), Vec3(0.02)), settings);
      ASSERT_TRUE(geometry);
      const auto scene = native::prepare_scene(*geometry, Plan{}, {});
      ASSERT_TRUE(scene);
      ASSERT_NE(scene->samples, nullptr);
      const std::uint64_t foretold = native::most_sample_bytes(*geometry), kept = scene->samples->bytes();
      EXPECT_LE(kept, foretold);
      // Words are there twice while they are listed, and leaning faces have fewer samples, at least 1 / √3.
      EXPECT_GE(3 * kept, foretold);
    }
}

#ifndef PALPATE_SANITIZED                       // sanitizers take memory of their own
std::uint64_t status(const std::string& key) {  // of /proc/self/status, bytes
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(key)) return std::stoull(line.substr(key.size() + 1)) << 10;
  return 0;
}

TEST(Native, TakesNoMoreMemoryThanForetoldAndKeepsAtMostAHundredBytesATriangle) {
  std::uint64_t kept[2]{}, of[2]{};
  for (const std::uint64_t triangles : {100'000u, 400'000u}) {
    const auto scene = generate_scene("disassembly", triangles, 2000);
    ASSERT_TRUE(scene);
    const SceneGeometry geometry = built(scene->mockup, scene->tool);
    const auto native = make_native_backend();
    const std::uint64_t foretold = native->preparation_bytes(geometry, Plan{});
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak is of what follows
    const std::uint64_t before = status("VmRSS:");
    ASSERT_TRUE(native->prepare(geometry, Plan{}, {}));
    const std::uint64_t taken = status("VmHWM:") - before;
    EXPECT_LE(taken, foretold);
    EXPECT_LE(native->memory_bytes(), foretold);
    const std::uint64_t prepared = native->memory_bytes();
    kept[0] = std::exchange(kept[1], native->memory_bytes());
    of[0] = std::exchange(of[1], geometry.mockup.triangles.size());
    std::printf("%llu triangles: %.1f MiB taken, %.1f foretold, %.1f kept\n",
                static_cast<unsigned long long>(triangles), static_cast<double>(taken) / 1048576,
                static_cast<double>(foretold) / 1048576,
                static_cast<double>(native->memory_bytes()) / 1048576);
    Clearance found;  // what the planner's questions read is made by the first of them, and counts as well
    ASSERT_TRUE(native->clearance(*to_lattice({}, geometry), INT32_MAX - 2, found));
    EXPECT_LE(status("VmHWM:") - before, foretold);
    EXPECT_GT(native->memory_bytes(), prepared + 78 * geometry.mockup.triangles.size());
    EXPECT_LE(native->memory_bytes(), foretold);
    std::printf("with questions: %.1f MiB taken, %.1f kept\n",
                static_cast<double>(status("VmHWM:") - before) / 1048576,
                static_cast<double>(native->memory_bytes()) / 1048576);
  }
  EXPECT_LE(kept[1] - kept[0], 100 * (of[1] - of[0]));  // what the tool takes is the same for both
}

/// Held against the heap, which knows of every part: a vector that nobody counts is a number that nobody can
/// trust. Both engines that keep theirs there.
TEST(Native, TellsAllThatItKeepsOfMemoryAndSoDoesTheReference) {
  ASSERT_EQ(mallopt(M_ARENA_MAX, 1), 1);  // mallinfo2() tells of the first one alone
  const auto heap = [] {
    const struct mallinfo2 all = mallinfo2();
    return static_cast<std::int64_t>(all.uordblks + all.hblkhd);
  };
  for (const std::uint64_t tool_triangles : {2'000u, 50'000u}) {
    const auto scene = generate_scene("disassembly", 100'000, tool_triangles);
    ASSERT_TRUE(scene);
    const SceneGeometry geometry = built(scene->mockup, scene->tool);
    const LatticePose pose = at(geometry, Vec3(0));
    for (const bool is_native : {true, false}) {
      const std::int64_t before = heap();
      const auto engine = is_native ? make_native_backend() : make_ref_backend();
      const auto expect_all = [&](const std::string& after) {
        SCOPED_TRACE(engine->name() + " after " + after + ", a tool of " + std::to_string(tool_triangles) +
                     " triangles");
        // What malloc adds to each block, names, threads, and what a question's search has at hand: 64 to 160
        // KiB of 22 to 143 MiB, and 15 to 33 more by thread of a batch.
        const double small = (256 << 10) + (64 << 10) * (processors() - 1.0);
        EXPECT_NEAR(static_cast<double>(engine->memory_bytes()), static_cast<double>(heap() - before), small);
      };
      ASSERT_TRUE(engine->prepare(geometry, Plan{}, {}));
      expect_all("preparing");
      for (int i = 0; i < 2; ++i) {  // the first may have found its lists too small
        Contacts out;
        ASSERT_TRUE(engine->query(pose, nullptr, out));
        EXPECT_TRUE(out.contact);
      }
      expect_all("a frame");
      Clearance clearance;
      ASSERT_TRUE(engine->clearance(pose, INT32_MAX - 2, clearance));
      expect_all("a distance");
      {
        const std::vector<LatticePose> poses(is_native ? 4000 : 4, pose);
        std::vector<std::uint8_t> bits(poses.size());
        ASSERT_TRUE(engine->touches(poses, bits));
      }
      expect_all("a batch");
    }
  }
}
#endif

TEST(Native, RefusesWhatItDoesNotAnswer) {
  const SceneGeometry geometry = built(solids::box(Vec3(-0.1), Vec3(0.1)), solids::sphere(0.01));
  const auto native = make_native_backend();
  Plan paper;
  paper.profile = Profile::kPaper;
  const auto refused = native->prepare(geometry, paper, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadValue);
  Contacts out;
  const LatticePose pose = at(geometry, Vec3(0, 0, 0.105));
  EXPECT_FALSE(native->query(pose, nullptr, out));
  ASSERT_TRUE(native->prepare(geometry, Plan{}, {}));
  EXPECT_FALSE(native->replan(paper));
  EXPECT_TRUE(native->query(pose, nullptr, out));
  EXPECT_TRUE(out.contact);
}

}  // namespace
}  // namespace palpate
