// A back end with a spare: who is asked about what.
#include "service/loop/steady_backend.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate {
namespace {

/// Answers with the scene that it has prepared as the number of pairs; may find every frame too large, or
/// never be ready.
class Teller final : public CollisionBackend {
 public:
  explicit Teller(bool truncates, bool finishes = true) : truncates_(truncates), finishes_(finishes) {}
  Result<void> finish_preparing() override {
    return finishes_ ? Result<void>{} : Error{ErrorCode::kInternal, "a shader can't be compiled"};
  }
  Result<void> prepare(const SceneGeometry& geometry, const Plan&, const Progress&) override {
    scene_ = static_cast<std::uint64_t>(geometry.sample_spacing);
    return {};
  }
  Result<void> query(const LatticePose&, const Ignored*, Contacts& out) override {
    out = {};
    out.pairs = scene_;
    out.truncated = truncates_;
    out.truncated_capacity = truncates_ ? "something" : "";
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return false; }
  std::string name() const override { return truncates_ ? "first" : "spare"; }
  std::string device() const override { return name(); }
  std::uint64_t memory_bytes() const override { return 0; }

 private:
  bool truncates_, finishes_;
  std::uint64_t scene_ = 0;
};

TEST(SteadyBackend, ANewSceneIsNewToTheSpareToo) {
  // The spare once went on with the scene before, of whose geometry nothing was left.
  SteadyBackend backend(std::make_unique<Teller>(true), [] { return std::make_unique<Teller>(false); });
  Contacts out;
  for (const int scene : {3, 4, 5}) {
    SceneGeometry geometry;
    geometry.sample_spacing = scene;
    ASSERT_TRUE(backend.prepare(geometry, {}, {}));
    ASSERT_TRUE(backend.query({}, nullptr, out));
    EXPECT_FALSE(out.truncated);
    EXPECT_EQ(out.pairs, static_cast<std::uint64_t>(scene));
  }
}

/// Answers scenes of one profile alone, as the native engine does.
class Choosy final : public CollisionBackend {
 public:
  Choosy(const char* name, Profile profile) : name_(name), profile_(profile) {}
  Result<void> prepare(const SceneGeometry&, const Plan& plan, const Progress&) override {
    return plan.profile == profile_ ? Result<void>{} : bad_value("another profile");
  }
  Result<void> query(const LatticePose&, const Ignored*, Contacts& out) override {
    out = {};
    out.engine = name_;
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return false; }
  std::string name() const override { return name_; }
  std::string device() const override { return name_; }
  std::uint64_t memory_bytes() const override { return 0; }

 private:
  const char* name_;
  Profile profile_;
};

TEST(SteadyBackend, ASceneThatTheFirstDoesNotTakeIsTheSparesAndTheNextIsTheFirstsAgain) {
  SteadyBackend backend(std::make_unique<Choosy>("first", Profile::kRefined),
                        [] { return std::make_unique<Choosy>("spare", Profile::kPaper); });
  const SceneGeometry geometry;
  Contacts out;
  std::vector<Contacts> batch(3);
  const std::vector<LatticePose> poses(3);
  for (const Profile profile : {Profile::kRefined, Profile::kPaper, Profile::kRefined, Profile::kPaper}) {
    const std::string who = profile == Profile::kRefined ? "first" : "spare";
    Plan plan;
    plan.profile = profile;
    ASSERT_TRUE(backend.prepare(geometry, plan, {}));
    EXPECT_EQ(backend.name(), who);
    ASSERT_TRUE(backend.finish_preparing());
    ASSERT_TRUE(backend.query({}, nullptr, out));
    EXPECT_EQ(out.engine, who);
    ASSERT_TRUE(backend.query_batch(poses, batch));
    for (const Contacts& contacts : batch) EXPECT_EQ(contacts.engine, who);
  }
}

/// Cuts every third pose short; answers with itself as the engine.
class CutsShort final : public CollisionBackend {
 public:
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override { return {}; }
  Result<void> query(const LatticePose& pose, const Ignored*, Contacts& out) override {
    out = {};
    out.engine = "cuts short";
    out.truncated = pose.translation.x % 3 == 0;
    out.truncated_capacity = out.truncated ? "something" : "";
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return false; }
  std::string name() const override { return "cuts short"; }
  std::string device() const override { return name(); }
  std::uint64_t memory_bytes() const override { return 0; }
};

TEST(SteadyBackend, SharedWorkThatIsCutShortIsDoneAgainAloneAndNoOther) {
  SteadyBackend backend(std::make_unique<CutsShort>(),
                        [] { return std::make_unique<Choosy>("spare", Profile::kRefined); });
  ASSERT_TRUE(backend.prepare(SceneGeometry{}, {}, {}));
  std::vector<std::string> engines(10);
  std::vector<int> times(10);
  ASSERT_TRUE(backend.share(engines.size(), [&](PoseQuery& asked, std::size_t i) -> Result<void> {
    ++times[i];
    LatticePose pose{};
    pose.translation.x = static_cast<std::int32_t>(i);
    Contacts out;
    for (int again = 0; again < 2; ++again)  // a piece may ask as often as it likes
      if (auto done = asked.query(pose, nullptr, out); !done) return done;
    engines[i] = out.engine;
    return {};
  }));
  for (std::size_t i = 0; i < engines.size(); ++i) {
    EXPECT_EQ(engines[i], i % 3 == 0 ? "spare" : "cuts short") << i;
    EXPECT_EQ(times[i], i % 3 == 0 ? 2 : 1) << i;
  }
  EXPECT_FALSE(backend.share(3, [](PoseQuery&, std::size_t i) -> Result<void> {
    return i == 1 ? Result<void>(bad_value("no")) : Result<void>();
  }));
}

TEST(SteadyBackend, TellsWhatASpareWithASpareOfItsOwnHasToTell) {
  SteadyBackend backend(std::make_unique<Choosy>("first", Profile::kRefined), [] {
    return std::make_unique<SteadyBackend>(std::make_unique<Choosy>("second", Profile::kRefined),
                                           [] { return std::make_unique<Choosy>("third", Profile::kPaper); });
  });
  const SceneGeometry geometry;
  Plan plan;
  plan.profile = Profile::kPaper;
  ASSERT_TRUE(backend.prepare(geometry, plan, {}));
  EXPECT_EQ(backend.name(), "third");
  const auto notes = backend.take_notes();
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("prepared on second") != std::string::npos;
  }));
  EXPECT_TRUE(backend.take_notes().empty());
}

TEST(SteadyBackend, AFirstThatIsNeverReadyIsReplacedBeforeALoopBegins) {
  SceneGeometry geometry;
  geometry.sample_spacing = 3;
  SteadyBackend backend(std::make_unique<Teller>(true, false),
                        [] { return std::make_unique<Teller>(false); });
  ASSERT_TRUE(backend.prepare(geometry, {}, {}));
  EXPECT_EQ(backend.name(), "first");
  ASSERT_TRUE(backend.finish_preparing());
  EXPECT_EQ(backend.name(), "spare");
  const auto notes = backend.take_notes();
  ASSERT_EQ(notes.size(), 2u);
  EXPECT_NE(notes[0].find("a shader can't be compiled"), std::string::npos) << notes[0];

  SteadyBackend alone(std::make_unique<Teller>(true, false), nullptr);
  ASSERT_TRUE(alone.prepare(geometry, {}, {}));
  EXPECT_FALSE(alone.finish_preparing());
}

}  // namespace
}  // namespace palpate
