// A batch is the same answers, sooner; preparation takes what was foretold.
#include <gtest/gtest.h>

#include <span>

#include "compute/gpu_backend.h"
#include "compute/prepare_estimate.h"
#include "compute/prepared_scene.h"
#include "model/generate.h"
#include "model/geometry_build.h"
#include "model/path_file.h"
#include "tests/equivalence/contacts_difference.h"

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
    out.poses.push_back(*to_lattice(path_pose(scene->path[i * scene->path.size() / count], scene->guide), out.geometry));
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

TEST(Batch, IsTheBitsOfSingleQueries) {
  const Subject scene = subject("disassembly", 8000, 300);
  GpuOptions options;
  options.validation = true;
  const auto backend = prepared(options, scene);
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
  expect_same(*backend, std::span(scene.poses).subspan(120, 7), 0);
}

TEST(Batch, EnlargesWhatIsTooSmallOnEveryThread) {
  const Subject scene = subject("disassembly", 8000, 200);
  GpuOptions options;
  options.first_capacity = {{"pairs", 3}, {"pairs to test", 3}, {"samples", 3}};
  const auto backend = prepared(options, scene);
  expect_same(*backend, scene.poses, scene.poses.size() / 4);
}

TEST(Batch, EndsWithTheErrorOfAPoseThatFails) {
  const Subject scene = subject("disassembly", 4000, 200);
  const auto fault = std::make_shared<GpuFault>();
  GpuOptions options;
  options.fault = fault;
  options.host_share = HostShare::kAreas;   // what the host solves is never submitted
  const auto backend = prepared(options, scene);
  std::vector<Contacts> out(scene.poses.size());
  ASSERT_TRUE(backend->query_batch(scene.poses, out));
  fault->after = 100;
  fault->call = GpuFault::Call::kSubmit;
  const auto lost = backend->query_batch(scene.poses, out);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().sentence.find("the device was lost"), std::string::npos) << lost.error().sentence;
}

TEST(Preparation, TakesNoMoreThanForetoldAndNotFarLess) {
  for (const auto& [name, triangles] : {std::pair{"disassembly", 1000}, {"contacts", 25'000}, {"disassembly", 100'000}, {"disassembly", 300'000}}) {
    const Subject scene = subject(name, static_cast<std::uint64_t>(triangles), 1);
    auto device = VulkanDevice::create({});
    ASSERT_TRUE(device);
    const auto prepared = prepare_scene(**device, scene.geometry, Plan{}, {});
    ASSERT_TRUE(prepared) << prepared.error().sentence;
    const std::uint64_t foretold = estimate_preparation(scene.geometry, Plan{}), taken = (*device)->most_allocated;
    EXPECT_LE(taken, foretold) << name << " " << triangles;
    EXPECT_GE(4 * taken + (std::uint64_t{256} << 20), foretold) << name << " " << triangles;
    std::printf("%s %d: taken %.1f MiB, foretold %.1f MiB\n", name, triangles, static_cast<double>(taken) / 1048576, static_cast<double>(foretold) / 1048576);
  }
}

TEST(Preparation, IsRefusedInASentenceBeforeItTakesWhatIsNotThere) {
  Subject scene = subject("disassembly", 4000, 1);
  scene.geometry.mockup_grid.size = 1;   // lists without end
  const auto backend = make_gpu_backend({});
  ASSERT_TRUE(backend);
  bool begun = false;
  const auto refused = (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return begun = true; });
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
  const auto cancelled = (*backend)->prepare(scene.geometry, Plan{}, [&](const char*, double) { return ++asked < 10; });
  ASSERT_FALSE(cancelled);
  EXPECT_EQ(cancelled.error().sentence, "preparation was cancelled");
  EXPECT_EQ(asked, 10) << "nobody is asked again";
}

}  // namespace
}  // namespace palpate
