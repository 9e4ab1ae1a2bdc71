// A batch is the same answers, sooner.
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "model/generate.h"
#include "model/processors.h"
#include "tests/compute/subject.h"
#include "tests/equivalence/contacts_difference.h"
#include "tests/faults/fault_scene.h"

namespace palpate {
namespace {

std::unique_ptr<CollisionBackend> prepared(const GpuOptions& options, const Subject& subject) {
  auto made = make_gpu_backend(options);
  EXPECT_TRUE(made) << made.error().sentence;
  const auto done = (*made)->prepare(subject.geometry, Plan{}, {});
  EXPECT_TRUE(done) << done.error().sentence;
  return std::move(*made);
}

std::vector<Contacts> singles(CollisionBackend& backend, std::span<const LatticePose> poses) {
  std::vector<Contacts> out(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_TRUE(backend.query(poses[i], nullptr, out[i]));
    while (out[i].truncated) {
      if (!backend.enlarge()) throw std::runtime_error("a pose stays truncated");
      EXPECT_TRUE(backend.query(poses[i], nullptr, out[i]));
    }
  }
  return out;
}

void expect_same(CollisionBackend& backend, std::span<const LatticePose> poses,
                 std::span<const Contacts> singles, std::size_t least_contacts) {
  std::vector<Contacts> batch(poses.size());
  // Twice: the first batch that is worth it sets its threads up.
  for (int round = 0; round < 2; ++round) {
    const auto answered = backend.query_batch(poses, batch);
    ASSERT_TRUE(answered) << answered.error().sentence;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      EXPECT_EQ(first_difference(batch[i], singles[i]), "") << "pose " << i;
      contacts += singles[i].contact ? 1u : 0u;
    }
    EXPECT_GE(contacts, least_contacts);
  }
}

void expect_same(CollisionBackend& backend, std::span<const LatticePose> poses, std::size_t least_contacts) {
  expect_same(backend, poses, singles(backend, poses), least_contacts);
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
  const std::vector<Contacts> all = singles(*backend, scene.poses);
  for (const std::size_t size :
       {1u, 2u, 7u, 8u, 9u, 31u, 32u, 33u, 63u, 64u, 65u, 127u, 128u, 129u, 256u, 257u}) {
    SCOPED_TRACE(size);
    expect_same(*backend, std::span(scene.poses).first(size), all, 0);
  }
}

// Asked without the field; what a grid's lists have no room for a lone frame answers.
TEST(Touches, AreTheContactOfSingleQueries) {
  const Subject scene = subject("disassembly", 4000, 260);
  for (const bool small : {false, true}) {
    GpuOptions options;
    if (small) options.first_capacity = {{"lists of touched voxels", 40}};
    const auto backend = prepared(options, scene);
    const std::vector<Contacts> all = singles(*backend, scene.poses);
    std::size_t touching = 0;
    for (const std::size_t size : {257u, 1u, 64u, 257u}) {
      SCOPED_TRACE(size);
      std::vector<std::uint8_t> bits(size, 7);
      const auto done = backend->touches(std::span(scene.poses).first(size), bits);
      ASSERT_TRUE(done) << done.error().sentence;
      for (std::size_t i = 0; i < size; ++i) {
        EXPECT_EQ(bits[i], all[i].contact ? 1 : 0) << "pose " << i;
        touching += bits[i];
      }
    }
    EXPECT_GT(touching, 60u);
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

}  // namespace
}  // namespace palpate
