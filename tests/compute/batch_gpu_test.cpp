// A batch is the same answers, sooner; preparation takes what was foretold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "compute/gpu/frame/frame.h"
#include "compute/gpu/frame/pose_grid.h"
#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/native/native_backend.h"
#include "compute/native/prepare/sample_lists.h"
#include "compute/native/prepare/scene.h"
#include "compute/scene/estimate.h"
#include "compute/scene/exact.h"
#include "compute/scene/search_tables.h"
#include "cpu_ref/ref_backend.h"
#include "model/files/path_file.h"
#include "model/generate.h"
#include "model/processors.h"
#include "model/scene/geometry_build.h"
#include "shaders/shared/frame.h"
#include "tests/compute/partition_equality.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/faults/fault_scene.h"

namespace palpate {
namespace {

struct Subject {
  SceneGeometry geometry;
  std::vector<LatticePose> poses;
};

/// A scene of the chapter and poses along its path.
Subject subject(const char* name, std::uint64_t triangles, std::size_t count) {
  Subject out;
  const auto scene = generate_scene(name, triangles, 1000);
  EXPECT_TRUE(scene);
  auto geometry = build_geometry(scene->mockup, scene->tool, {});
  EXPECT_TRUE(geometry);
  out.geometry = std::move(*geometry);
  for (std::size_t i = 0; i < count; ++i)
    out.poses.push_back(
        *to_lattice(path_pose(scene->path[i * scene->path.size() / count], scene->guide), out.geometry));
  return out;
}

std::unique_ptr<CollisionBackend> prepared(const GpuOptions& options, const Subject& subject) {
  auto made = make_gpu_backend(options);
  EXPECT_TRUE(made) << made.error().sentence;
  const auto done = (*made)->prepare(subject.geometry, Plan{}, {});
  EXPECT_TRUE(done) << done.error().sentence;
  return std::move(*made);
}

void expect_same(CollisionBackend& backend, std::span<const LatticePose> poses, std::size_t least_contacts) {
  std::vector<Contacts> batch(poses.size());
  Contacts single;
  // Twice: the first batch that is worth it sets its threads up.
  for (int round = 0; round < 2; ++round) {
    const auto answered = backend.query_batch(poses, batch);
    ASSERT_TRUE(answered) << answered.error().sentence;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ASSERT_TRUE(backend.query(poses[i], nullptr, single));
      while (single.truncated) {
        ASSERT_TRUE(backend.enlarge());
        ASSERT_TRUE(backend.query(poses[i], nullptr, single));
      }
      EXPECT_EQ(first_difference(batch[i], single), "") << "pose " << i;
      contacts += single.contact ? 1 : 0;
    }
    EXPECT_GE(contacts, least_contacts);
  }
}

/// Threads have a device each on lavapipe, and one together where it has memory of its own, as a GPU has.
class Batch : public testing::TestWithParam<bool> {
 protected:
  static GpuOptions options_here() {
    GpuOptions options;
    options.own_memory = GetParam();
    return options;
  }
};
INSTANTIATE_TEST_SUITE_P(HostOrOwn, Batch, testing::Bool(), [](const auto& own) {
  return own.param ? std::string("own_memory") : std::string("host_memory");
});

TEST_P(Batch, IsTheBitsOfSingleQueries) {
  const Subject scene = subject("disassembly", 8000, 300);
  GpuOptions options = options_here();
  options.validation = true;
  options.guard_buffers = GetParam();
  const auto backend = prepared(options, scene);
  const std::uint64_t bytes = backend->memory_bytes();
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
  expect_same(*backend, std::span(scene.poses).subspan(120, 7), 0);
  if (processors() > 1) {
    EXPECT_GT(backend->memory_bytes(), bytes) << "no thread has a frame";
  }
}

TEST(NativeBatch, IsTheBitsOfSingleQueries) {
  const Subject scene = subject("disassembly", 8000, 300);
  const auto backend = make_native_backend();
  ASSERT_TRUE(backend->prepare(scene.geometry, Plan{}, {}));
  const std::uint64_t bytes = backend->memory_bytes();
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
  expect_same(*backend, std::span(scene.poses).subspan(120, 7), 0);
  if (processors() > 1) {
    EXPECT_GT(backend->memory_bytes(), bytes) << "no thread has a frame";
  }
}

TEST(RefBatch, IsTheBitsOfSingleQueries) {
  const Subject scene = subject("disassembly", 2000, 140);
  const auto backend = make_ref_backend();
  ASSERT_TRUE(backend->prepare(scene.geometry, Plan{}, {}));
  const std::uint64_t bytes = backend->memory_bytes();
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
  if (processors() > 1) {
    EXPECT_GT(backend->memory_bytes(), bytes) << "no thread has somebody to ask";
  }
}

// Threads are made at kWorthThreads; from then on poses are handed out in pieces of at least 32, or 256.
TEST_P(Batch, OfEverySizeIsTheBitsOfSingleQueries) {
  const Subject scene = subject("disassembly", 4000, 260);
  const auto backend = prepared(options_here(), scene);
  for (const std::size_t size :
       {1u, 2u, 7u, 8u, 9u, 31u, 32u, 33u, 63u, 64u, 65u, 127u, 128u, 129u, 256u, 257u}) {
    SCOPED_TRACE(size);
    expect_same(*backend, std::span(scene.poses).first(size), 0);
  }
}

// A pose that is more than a frame may ever take (`paper`: 289 areas) is cut short alone.
TEST_P(Batch, AnOverflowThatNoRoomMendsHarmsNoOtherPose) {
  Mesh posts;
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      solids::append(posts,
                     solids::box(Vec3(i, j, 0) * 0.003, Vec3(i, j, 0) * 0.003 + Vec3(0.001, 0.001, 0.003)),
                     "post");
  const auto scene = make_fault_scene(
      "posts", posts, solids::box(Vec3(-0.04, -0.04, 0), Vec3(0.04, 0.04, 0.004)), Vec3(0, 0, 0.0025));
  Plan paper;
  paper.profile = Profile::kPaper;
  auto made = make_gpu_backend(options_here());
  ASSERT_TRUE(made);
  const auto reference = make_ref_backend();
  ASSERT_TRUE((*made)->prepare(scene->geometry, paper, {}) && reference->prepare(scene->geometry, paper, {}));
  std::vector<LatticePose> poses;
  constexpr std::size_t kWhole = 70;
  for (std::size_t i = 0; i < 200; ++i)
    poses.push_back(at(*scene, i == kWhole ? Vec3(0, 0, 0.0025)
                                           : Vec3(0.055 + 0.00002 * static_cast<double>(i), 0,
                                                  0.0025)));  // a corner of the plate on a few posts
  std::vector<Contacts> batch(poses.size()), expected(poses.size());
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE((*made)->query_batch(poses, batch));
    ASSERT_TRUE(reference->query_batch(poses, expected));
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(batch[i].truncated, i == kWhole) << i;
      EXPECT_EQ(first_difference(batch[i], expected[i]), "") << i;
      contacts += batch[i].contact ? 1u : 0u;
    }
    EXPECT_GT(contacts, 100u);
  }
}

// Counts are the same on every device: what a frame asks for does not depend on what it finds.
TEST(DeviceWork, ARefinedFrameIsOneSubmissionOfTenDispatches) {
  for (const auto& [name, triangles] : {std::pair{"disassembly", 4000}, {"contacts", 8000}}) {
    const Subject scene = subject(name, static_cast<std::uint64_t>(triangles), 120);
    const auto backend = prepared({}, scene);
    Contacts out;
    std::size_t contacts = 0;
    for (const LatticePose& pose : scene.poses) {
      const DeviceWork before = backend->device_work();
      ASSERT_TRUE(backend->query(pose, nullptr, out));
      const DeviceWork after = backend->device_work();
      EXPECT_EQ(after.submissions - before.submissions, 1u);
      EXPECT_LE(after.dispatches - before.dispatches, 10u);
      EXPECT_LE(after.barriers - before.barriers, 8u);
      EXPECT_GT(after.bytes_up, before.bytes_up);
      EXPECT_GT(after.bytes_down, before.bytes_down);
      contacts += out.contact ? 1u : 0u;
    }
    EXPECT_GT(contacts, 20u) << name;
  }
}

TEST_P(Batch, EnlargesWhatIsTooSmallOnEveryThread) {
  const Subject scene = subject("disassembly", 8000, 200);
  GpuOptions options = options_here();
  options.first_capacity = {{"pairs", 3}, {"pairs to test", 3}, {"samples", 3}};
  const auto backend = prepared(options, scene);
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
}

TEST_P(Batch, EndsWithTheErrorOfAPoseThatFails) {
  const Subject scene = subject("disassembly", 4000, 200);
  const auto fault = std::make_shared<GpuFault>();
  GpuOptions options = options_here();
  options.fault = fault;
  const auto backend = prepared(options, scene);
  std::vector<Contacts> out(scene.poses.size());
  ASSERT_TRUE(backend->query_batch(scene.poses, out));
  fault->after = GetParam() ? 0 : 2;  // submissions of a batch: one, or several
  fault->call = GpuFault::Call::kSubmit;
  const auto lost = backend->query_batch(scene.poses, out);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().sentence.find("the device was lost"), std::string::npos) << lost.error().sentence;
}

template <class T>
T taken(Result<T>&& made) {
  EXPECT_TRUE(made) << made.error().sentence;
  return std::move(*made);
}

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
        "samples near the tool's surface", "samples", "tiles of tool samples", "samples of the tool"}) {
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

/// Triangles of all sizes and directions, slivers among them.
Mesh soup(std::size_t triangles) {
  Mesh mesh;
  std::mt19937 random(20);
  std::uniform_real_distribution<double> place(-0.5, 0.5), power(-3.5, 0);
  for (std::size_t i = 0; i < triangles; ++i) {
    const Vec3 at(place(random), place(random), place(random));
    const double size = std::pow(10, power(random)), thin = i % 3 == 0 ? 0.001 : 1;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 along(place(random), place(random), place(random)),
        across(place(random), place(random), place(random));
    mesh.vertices.insert(mesh.vertices.end(), {at, at + size * along, at + size * thin * across});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.parts = {{"", 0, static_cast<std::uint32_t>(triangles)}};
  return mesh;
}

/// Whether every voxel's points are the 1024ths that hold its triangles' first corners, each once and with
/// all that begin there, and then their samples, one by one, with axis and entry.
testing::AssertionResult points_are_right(const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const gpu::GridConstants& grid_of_voxels = lists.grid;
  const VoxelSamples& samples = *scene.samples;
  std::vector<std::uint32_t> expected;
  std::vector<std::uint16_t> entries, owners;
  std::vector<VoxelSamples::Begin> begins{{0, 0, 0}};
  std::uint32_t number = 0;  // of the next sample
  for (std::size_t voxel = 0; voxel < lists.boundary_place.size(); ++voxel) {
    const Int3 low = grid_of_voxels.origin +
                     grid_of_voxels.size * lists.boundary_voxel(static_cast<std::uint32_t>(voxel)),
               high = low + (grid_of_voxels.size - 1);
    const VoxelSamples::Voxel grid(low, geometry.sample_spacing);
    const auto put = [&](const Int3& point, std::size_t entry, std::uint32_t axis) {
      const auto part = [&](int k) {
        return static_cast<std::uint32_t>(std::floor(1024.0 * (point[k] - low[k]) / grid_of_voxels.size));
      };  // exact: below 2^39
      expected.push_back(part(0) | part(1) << 10 | part(2) << 20 | axis << 30);
      entries.push_back(static_cast<std::uint16_t>(entry));
    };
    const auto for_triangles = [&](auto&& take) {
      for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e)
        take(e, exact::Corners{geometry.mockup.corner(lists.list_triangles[e], 0),
                               geometry.mockup.corner(lists.list_triangles[e], 1),
                               geometry.mockup.corner(lists.list_triangles[e], 2)});
    };
    std::map<std::uint32_t, std::vector<std::uint32_t>> corners;  // entries by vertex
    for_triangles([&](std::uint32_t e, const exact::Corners& t) {
      if (t[0] == glm::clamp(t[0], low, high))
        corners[geometry.mockup.triangles[lists.list_triangles[e]][0]].push_back(e - lists.list_begin[voxel]);
    });
    const std::size_t first_owner = owners.size();
    for (const auto& [vertex, its] : corners) {
      put(geometry.mockup.vertices[vertex], owners.size() - first_owner, 0);
      owners.insert(owners.end(), its.begin(), its.end());
    }
    bool same = true;
    for_triangles([&](std::uint32_t e, const exact::Corners& t) {
      const std::uint8_t axis = geometry.mockup.sample_axis[lists.list_triangles[e]];
      exact::for_samples(
          t, axis, geometry.sample_spacing, low, high, [&](const Int3& point, std::int64_t, std::int64_t) {
            put(point, e - lists.list_begin[voxel], axis);
            same = same && number < samples.count() && samples.sample(grid, axis, number) == point;
            ++number;
          });
    });
    if (!same) return testing::AssertionFailure() << "samples of voxel " << voxel << " differ";
    begins.push_back(
        {static_cast<std::uint32_t>(expected.size()), number, static_cast<std::uint32_t>(owners.size())});
  }
  if (samples.begin != begins) return testing::AssertionFailure() << "begins differ";
  if (samples.entries != entries) return testing::AssertionFailure() << "entries differ";
  if (samples.owners != owners) return testing::AssertionFailure() << "owners differ";
  if (samples.points.size() != expected.size() + VoxelSamples::kPointsAtOnce - 1 ||
      !std::equal(expected.begin(), expected.end(), samples.points.begin()))
    return testing::AssertionFailure() << "points differ";
  return testing::AssertionSuccess();
}

/// Whether every listed triangle's box, as far as it lies in its voxel, is rounded down to 256ths of the
/// voxel.
testing::AssertionResult boxes_are_right(const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const gpu::GridConstants& grid_of_voxels = lists.grid;
  const std::vector<std::uint8_t>& boxes = scene.search->boxes;
  if (boxes.size() != 6 * lists.list_triangles.size() + SearchTables::kBoxesAtOnce)
    return testing::AssertionFailure() << boxes.size() << " bytes of boxes";
  for (std::size_t voxel = 0; voxel < lists.boundary_place.size(); ++voxel) {
    const Int3 low =
        grid_of_voxels.origin + grid_of_voxels.size * lists.boundary_voxel(static_cast<std::uint32_t>(voxel));
    const std::size_t count = lists.list_begin[voxel + 1] - lists.list_begin[voxel];
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 6; ++k) {
        const int axis = static_cast<int>(k % 3);
        const auto corner = [&](int c) {
          return geometry.mockup.corner(lists.list_triangles[lists.list_begin[voxel] + i], c)[axis];
        };
        const std::int32_t end =
            k < 3 ? std::min({corner(0), corner(1), corner(2)}) : std::max({corner(0), corner(1), corner(2)});
        const double part = 256.0 * std::clamp(end - low[axis], 0, grid_of_voxels.size - 1) /
                            grid_of_voxels.size,
                     found = boxes[6 * lists.list_begin[voxel] + k * count + i];
        if (found > part + 1e-9 || found < part - 1 - 1e-9)
          return testing::AssertionFailure()
                 << "voxel " << voxel << ", entry " << i << ", end " << k << ": " << found << ", " << part;
      }
  }
  return testing::AssertionSuccess();
}

/// What a buffer of words holds.
std::vector<std::uint32_t> words_of(VulkanDevice& device, const VulkanBuffer& buffer, std::size_t count) {
  std::vector<std::uint32_t> out(count);
  EXPECT_GE(buffer.bytes(), 4 * count);
  EXPECT_TRUE(download(device, buffer, 0, out.data(), 4 * count));
  return out;
}

/// Whether a voxel's points on the device are the samples and first corners of the triangles that it lists,
/// in any order.
testing::AssertionResult device_points_are_right(VulkanDevice& device, const PreparedScene& prepared,
                                                 const SceneGeometry& geometry, const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const std::int32_t size = lists.grid.size;
  const std::size_t voxels = lists.grid.boundary_voxels, each = size > gpu::kNarrowVoxel ? 3 : 2;
  const auto begin = words_of(device, prepared.sample_begin, voxels + 1);
  const auto points = words_of(device, prepared.sample_points, each * begin.back()),
             ids = words_of(device, prepared.sample_ids, begin.back());
  for (std::uint32_t voxel = 0; voxel < voxels; ++voxel) {
    const Int3 low = lists.grid.origin + size * lists.boundary_voxel(voxel), high = low + (size - 1);
    std::vector<std::array<std::int64_t, 4>> expected, found;
    const auto put = [](auto& to, const Int3& p, std::uint32_t id) { to.push_back({p.x, p.y, p.z, id}); };
    for (std::uint32_t e = lists.list_begin[voxel]; e < lists.list_begin[voxel + 1]; ++e) {
      const std::uint32_t id = lists.list_triangles[e];
      const exact::Corners t{geometry.mockup.corner(id, 0), geometry.mockup.corner(id, 1),
                             geometry.mockup.corner(id, 2)};
      if (t[0] == glm::clamp(t[0], low, high)) put(expected, t[0], id | gpu::kCornerProbe);
      exact::for_samples(t, geometry.mockup.sample_axis[id], geometry.sample_spacing, low, high,
                         [&](const Int3& p, std::int64_t, std::int64_t) { put(expected, p, id); });
    }
    for (std::size_t i = begin[voxel]; i < begin[voxel + 1]; ++i) {
      Int3 d;
      if (each == 3) {
        for (int k = 0; k < 3; ++k)
          d[k] = static_cast<std::int32_t>(points[3 * i + static_cast<std::size_t>(k)]);
      } else {
        const std::uint64_t packed = points[2 * i] | std::uint64_t{points[2 * i + 1]} << 32;
        for (int k = 0; k < 3; ++k) d[k] = static_cast<std::int32_t>(packed >> 20 * k & 0xFFFFF);
      }
      put(found, low + d, ids[i]);
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    if (found != expected) return testing::AssertionFailure() << "points of voxel " << voxel << " differ";
  }
  return testing::AssertionSuccess();
}

/// Whether the device's boxes are those of the native engine's search, in 32nds of the voxel.
testing::AssertionResult device_boxes_are_right(VulkanDevice& device, const PreparedScene& prepared,
                                                const native::Scene& scene) {
  const PartitionView lists = scene.mockup;
  const auto words = words_of(device, prepared.list_boxes, lists.grid.list_entries);
  for (std::uint32_t voxel = 0; voxel < lists.grid.boundary_voxels; ++voxel) {
    const std::size_t begin = lists.list_begin[voxel], count = lists.list_begin[voxel + 1] - begin;
    for (std::size_t i = 0; i < count; ++i)
      for (std::uint32_t k = 0; k < 6; ++k)
        if ((words[begin + i] >> 5 * k & 31u) != scene.search->boxes[6 * begin + k * count + i] / 8)
          return testing::AssertionFailure() << "voxel " << voxel << ", entry " << i << ", end " << k;
  }
  return testing::AssertionSuccess();
}

/// Boxes of what is connected by corners and fits into the tool: by labels that spread until none changes.
std::vector<std::array<std::int32_t, 6>> parts_of(const SceneGeometry& geometry) {
  const LatticeMesh& mesh = geometry.mockup;
  std::vector<std::uint32_t> label(mesh.vertices.size());
  for (std::uint32_t v = 0; v < label.size(); ++v) label[v] = v;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (mesh.collapsed(t)) continue;
      const auto& [a, b, c] = mesh.triangles[t];
      const std::uint32_t least = std::min({label[a], label[b], label[c]});
      for (const std::uint32_t v : {a, b, c}) changed = changed || label[v] != least, label[v] = least;
    }
  }
  std::map<std::uint32_t, std::array<std::int32_t, 6>> boxes;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    const Int3 first = mesh.corner(t, 0);
    auto& box = boxes
                    .try_emplace(label[mesh.triangles[t][0]],
                                 std::array{first.x, first.y, first.z, first.x, first.y, first.z})
                    .first->second;
    for (int corner = 0; corner < 3; ++corner)
      for (int k = 0; k < 3; ++k) {
        auto &low = box[static_cast<std::size_t>(k)], &high = box[static_cast<std::size_t>(k) + 3];
        low = std::min(low, mesh.corner(t, corner)[k]);
        high = std::max(high, mesh.corner(t, corner)[k]);
      }
  }
  std::vector<std::array<std::int32_t, 6>> out;
  const auto most = 2 * std::int64_t{geometry.tool_radius} + 2 * gpu::kCloseSteps;
  for (const auto& [root, box] : boxes)
    if (std::int64_t{box[3]} - box[0] <= most && std::int64_t{box[4]} - box[1] <= most &&
        std::int64_t{box[5]} - box[2] <= most)
      out.push_back(box);
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Preparation, ListsTheSameSamplesInBothEnginesAndRightTablesForTheSearch) {
  struct Mockup {
    const char* name;
    Mesh mesh;
    double voxel_m, spacing_m;
    bool wide;  ///< heights in a voxel of more than 2^20 steps
  };
  const auto contacts = generate_scene("contacts", 8000, 1000),
             disassembly = generate_scene("disassembly", 4000, 1000);
  ASSERT_TRUE(contacts && disassembly);
  for (const Mockup& mockup : {Mockup{"contacts", contacts->mockup, 0, 0, true},
                               Mockup{"disassembly", disassembly->mockup, 0, 0, true},
                               Mockup{"soup", soup(500), 0.003, 0.0011, false},
                               Mockup{"soup, large voxels", soup(2000), 0.25, 0.0091, true}}) {
    SCOPED_TRACE(mockup.name);
    GeometrySettings settings;
    if (mockup.voxel_m > 0) settings.voxel_size_m = mockup.voxel_m;
    if (mockup.spacing_m > 0) settings.sample_spacing_m = mockup.spacing_m;
    const auto geometry = build_geometry(mockup.mesh, contacts->tool, settings);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    auto device = VulkanDevice::create({});
    ASSERT_TRUE(device);
    const auto prepared = prepare_scene(**device, *geometry, Plan{}, {});
    ASSERT_TRUE(prepared) << prepared.error().sentence;
    const auto native = native::prepare_scene(*geometry, Plan{}, {});
    ASSERT_TRUE(native) << native.error().sentence;
    expect_equal_tables(**device, *prepared, *native);
    ASSERT_TRUE(native->samples);
    EXPECT_GT(native->samples->count(), 10'000u);
    EXPECT_EQ(native->samples->wide, mockup.wide);
    EXPECT_TRUE(points_are_right(*geometry, *native));
    EXPECT_TRUE(boxes_are_right(*geometry, *native));
    EXPECT_TRUE(device_points_are_right(**device, *prepared, *geometry, *native));
    EXPECT_TRUE(device_boxes_are_right(**device, *prepared, *native));
    auto parts = native->search->parts;
    std::sort(parts.begin(), parts.end());
    EXPECT_EQ(parts, parts_of(*geometry));
    if (std::string_view(mockup.name).starts_with("soup")) {
      EXPECT_GT(parts.size(), 100u);
    }
    EXPECT_FALSE(SearchTables::make(*geometry, native->mockup, [] { return false; })) << "cancelled";
    const auto listing = [&](std::uint64_t most_bytes, bool go_on) {
      EntrySamples out;
      return native::list_samples(
          geometry->mockup, native->mockup, geometry->sample_spacing, most_bytes,
          [&](double) { return go_on; }, out);
    };
    EXPECT_EQ(listing(std::uint64_t{1} << 30, true), Listing::kDone);
    EXPECT_EQ(listing(4000, true), Listing::kTooMany);
    EXPECT_EQ(listing(std::uint64_t{1} << 30, false), Listing::kCancelled);
  }
}

TEST(Preparation, ListsNoSamplesWhereAVoxelListsMoreThanCanBeToldApart) {
  LatticeMesh mesh;
  mesh.vertices = {{1, 1, 1}, {90, 1, 1}, {1, 90, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.sample_axis = {2};
  for (const std::uint32_t entries : {VoxelSamples::kLongestList, VoxelSamples::kLongestList + 1}) {
    Partition lists;  // one voxel of one brick; the triangle again and again
    lists.grid.origin = Int3(0);
    lists.grid.size = 100;
    lists.grid.bricks = Int3(1);
    lists.grid.mixed_bricks = lists.grid.boundary_voxels = 1;
    lists.grid.list_entries = entries;
    lists.list_begin = {0, entries};
    lists.list_triangles.resize(entries);
    lists.boundary_place = {0};
    lists.mixed_brick = {0};
    EntrySamples by_entry;
    const auto go_on = [](double) { return true; };
    ASSERT_EQ(native::list_samples(mesh, lists, 40, std::uint64_t{1} << 30, go_on, by_entry), Listing::kDone);
    VoxelSamples samples;
    const Listing outcome = list_points(mesh, lists, 40, go_on, std::move(by_entry), samples);
    EXPECT_EQ(outcome, entries == VoxelSamples::kLongestList ? Listing::kDone : Listing::kTooMany);
    if (outcome != Listing::kDone) continue;
    EXPECT_EQ(samples.entries.front(), 0);
    EXPECT_EQ(samples.entries.back(), VoxelSamples::kLongestList - 1);
    EXPECT_EQ(samples.owners.size(), VoxelSamples::kLongestList);  // of one corner
    EXPECT_EQ(samples.owners.back(), VoxelSamples::kLongestList - 1);
    EXPECT_EQ(samples.count(), 4 * VoxelSamples::kLongestList);  // of cells (1, 0), (0, 1), (2, 0) and (0, 2)
  }
}

TEST(Preparation, TakesNoMoreThanForetoldAndNotFarLess) {
  for (const auto& [name, triangles] : {std::pair{"disassembly", 1000},
                                        {"contacts", 25'000},
                                        {"disassembly", 100'000},
                                        {"disassembly", 300'000}}) {
    const Subject scene = subject(name, static_cast<std::uint64_t>(triangles), 1);
    auto device = VulkanDevice::create({});
    ASSERT_TRUE(device);
    const auto prepared = prepare_scene(**device, scene.geometry, Plan{}, {});
    ASSERT_TRUE(prepared) << prepared.error().sentence;
    const std::uint64_t foretold = estimate_preparation(scene.geometry, Plan{}),
                        taken = (*device)->most_allocated;
    EXPECT_LE(taken, foretold) << name << " " << triangles;
    EXPECT_GE(4 * taken + (std::uint64_t{256} << 20), foretold) << name << " " << triangles;
    std::printf("%s %d: taken %.1f MiB, foretold %.1f MiB\n", name, triangles,
                static_cast<double>(taken) / 1048576, static_cast<double>(foretold) / 1048576);
  }
}

TEST(Preparation, IsRefusedInASentenceBeforeItTakesWhatIsNotThere) {
  Subject scene = subject("disassembly", 4000, 1);
  scene.geometry.mockup_grid.size = 1;  // lists without end
  const auto backend = make_gpu_backend({});
  ASSERT_TRUE(backend);
  bool begun = false;
  const auto refused =
      (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return begun = true; });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadValue);
  EXPECT_NE(refused.error().sentence.find("MiB of memory of"), std::string::npos) << refused.error().sentence;
  EXPECT_FALSE(begun);
}

TEST(Preparation, EndsSoonAfterItIsCancelled) {
  const Subject scene = subject("disassembly", 4000, 1);
  const auto backend = make_gpu_backend({});
  ASSERT_TRUE(backend);
  int asked = 0;
  const auto cancelled =
      (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return ++asked < 10; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().sentence, "preparation was cancelled");
  EXPECT_EQ(asked, 10) << "nobody is asked again";
}

}  // namespace
}  // namespace palpate
