// A scene from the disk answers like one that was prepared; a damaged one is prepared anew.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "compute/native/native_backend.h"
#include "tests/faults/fault_scene.h"
#include "tests/model/temporary_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class PrepareCache : public testing::TestWithParam<const char*> {
 protected:
  /// A fresh back end, as in a fresh process; `prepared`: whether the progress told of preparation.
  std::unique_ptr<CollisionBackend> start(const FaultScene& scene, const Plan& plan, bool& prepared) {
    cache = std::make_shared<DiskCache>(DiskCache::Settings{folder.path("cache"), std::uint64_t{1} << 30, 0});
    auto made = native() ? make_native_backend(cache) : gpu();
    prepared = false;
    const auto done =
        made->prepare(scene.geometry, plan, [&](const char*, double) { return prepared = true; });
    EXPECT_TRUE(done) << (done ? "" : done.error().sentence);
    return made;
  }
  static bool native() { return std::string(GetParam()) == "cpu"; }
  std::vector<fs::path> files() const {
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder.path("cache"))) out.push_back(entry.path());
    return out;
  }
  TemporaryFolder folder;
  std::shared_ptr<DiskCache> cache;

 private:
  std::unique_ptr<CollisionBackend> gpu() const {
    GpuOptions options;
    options.validation = true;
    options.guard_buffers = true;
    options.cache = cache;
    auto made = make_gpu_backend(options);
    EXPECT_TRUE(made) << (made ? "" : made.error().sentence);
    return std::move(*made);
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, PrepareCache, testing::Values("gpu", "cpu"),
                         [](const auto& engine) { return std::string(engine.param); });

/// All that the two say of the scene and of its pose.
void expect_same(CollisionBackend& a, CollisionBackend& b, const FaultScene& scene, bool refined) {
  for (const bool tool : {false, true}) {
    if (tool && !refined) continue;
    const auto one = a.partition(tool), other = b.partition(tool);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(first_difference(*one, *other), "");
  }
  EXPECT_EQ(a.has_internal_voxels(), b.has_internal_voxels());
  Contacts from_a, from_b;
  for (const double lift : {0.0, 0.0004, -0.0007, 0.5}) {
    LatticePose pose = scene.pose;
    pose.translation.z += static_cast<std::int32_t>(lift / scene.geometry.lattice.step_m);
    ASSERT_TRUE(a.query(pose, nullptr, from_a));
    ASSERT_TRUE(b.query(pose, nullptr, from_b));
    EXPECT_EQ(first_difference(from_a, from_b), "") << "lifted by " << lift;
    EXPECT_FALSE(from_a.truncated);
  }
}

TEST_P(PrepareCache, ASecondStartPreparesNothingAndAnswersTheSame) {
  for (const auto& scene : {ball_on_edge(), needle_in_block(), ball_in_plate()})
    for (const Profile profile : {Profile::kRefined, Profile::kPaper}) {
      if (native() && profile == Profile::kPaper) continue;
      SCOPED_TRACE(scene->name);
      Plan plan;
      plan.profile = profile;
      bool worked_first = false, worked_second = false;
      const auto first = start(*scene, plan, worked_first), second = start(*scene, plan, worked_second);
      EXPECT_TRUE(worked_first);
      EXPECT_FALSE(worked_second);
      EXPECT_EQ(first->memory_bytes(), second->memory_bytes());
      expect_same(*first, *second, *scene, profile == Profile::kRefined);
      Contacts answer;
      ASSERT_TRUE(second->query(scene->pose, nullptr, answer));
      if (profile == Profile::kRefined) {
        EXPECT_EQ(first_difference(answer, scene->expected), "");
      }
    }
  EXPECT_EQ(files().size(), native() ? 3u : 6u);  // no scene or profile stands in for another
}

TEST_P(PrepareCache, ADamagedEntryIsMadeAnewAndSaid) {
  const auto scene = ball_on_edge();
  bool worked = false;
  const auto first = start(*scene, {}, worked);
  const std::uint64_t kept = first->memory_bytes();  // frames take more
  const fs::path path = files().at(0);
  const auto size = fs::file_size(path);
  for (const bool cut : {false, true}) {
    if (cut) {
      fs::resize_file(path, size / 2);
    } else {
      std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
      file.seekp(static_cast<std::streamoff>(size / 2));
      file.put('\x55').put('\xAA').put('\x55');
    }
    const auto again = start(*scene, {}, worked);
    EXPECT_TRUE(worked);
    EXPECT_THAT(cache->take_notes(), testing::ElementsAre(testing::HasSubstr("damaged")));
    EXPECT_EQ(again->memory_bytes(), kept);
    expect_same(*first, *again, *scene, true);
    EXPECT_EQ(fs::file_size(path), size);
    const auto known = start(*scene, {}, worked);
    EXPECT_FALSE(worked);
    EXPECT_THAT(cache->take_notes(), testing::IsEmpty());
  }
}

TEST_P(PrepareCache, OneStepMoreOfOneVertexIsAnotherScene) {
  const auto scene = ball_on_edge();
  bool worked = false;
  start(*scene, {}, worked);
  ++scene->geometry.mockup.vertices[0].x;
  start(*scene, {}, worked);
  EXPECT_TRUE(worked);
}

}  // namespace
}  // namespace palpate
