// Balances that are looked for together are those that are looked for one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "compute/native/native_backend.h"
#include "model/files/path_file.h"
#include "model/generate.h"
#include "model/scene/geometry_build.h"
#include "service/queries/lone_query.h"

namespace palpate {
namespace {

constexpr double kStiffness = 2000;

/// Counts how often it is asked, and for how many at most.
class Counting final : public PoseQuery {
 public:
  explicit Counting(PoseQuery& asked) : asked_(asked) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    ++alone;
    return asked_.query(pose, ignored, out);
  }
  Result<void> query_together(std::span<const LatticePose> poses, std::span<Contacts* const> out) override {
    ++rounds;
    most = std::max(most, poses.size());
    return asked_.query_together(poses, out);
  }
  std::size_t alone = 0, rounds = 0, most = 0;

 private:
  PoseQuery& asked_;
};

/// A field that trembles from place to place by a part of its pushes, as roundings make it.
class Trembling final : public PoseQuery {
 public:
  Trembling(PoseQuery& asked, double part) : asked_(asked), part_(part) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    if (auto done = asked_.query(pose, ignored, out); !done) return done;
    std::mt19937 random(static_cast<std::uint32_t>(pose.translation.x) * 31U +
                        static_cast<std::uint32_t>(pose.translation.y) * 37U +
                        static_cast<std::uint32_t>(pose.translation.z));
    std::uniform_real_distribution<double> some(-part_, part_);
    for (FieldBin& bin : out.field.bins)
      for (WideSum& push : bin.push)
        push.low += static_cast<std::int64_t>(
            some(random) * (static_cast<double>(push.high) * 0x1p32 + static_cast<double>(push.low)));
    return {};
  }

 private:
  PoseQuery& asked_;
  double part_;
};

/// The generated scene of contacts, prepared.
class OnContacts : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(scene);
    ASSERT_TRUE(geometry);
    ASSERT_TRUE(backend->prepare(*geometry, Plan{}, {}));
  }
  const Result<GeneratedScene> scene = generate_scene("contacts", 8000, 1000);
  const Result<SceneGeometry> geometry = build_geometry(scene->mockup, scene->tool, {});
  const std::unique_ptr<CollisionBackend> backend = make_native_backend();
  Contacts contacts;
};

TEST_F(OnContacts, ALoneQueryEndsWhereRoundingDoesAndSaysSoWhereItEndsTooEarly) {
  const auto ask = [&](PoseQuery& asked, const Pose& pose) {
    const LatticePose lattice = *to_lattice(pose, *geometry);
    ContactResponse response;
    EXPECT_TRUE(asked.query(lattice, nullptr, contacts));
    respond(contacts, lattice, *geometry, Profile::kRefined, kStiffness, response);
    return *LoneQuery(*geometry, kStiffness).ask(asked, nullptr, pose, response);
  };
  Trembling little(*backend, 1e-4), much(*backend, 0.1);
  int asked = 0, lost = 0;
  for (std::size_t i = 0; i < scene->path.size(); i += 20) {
    const Pose pose = path_pose(scene->path[i], scene->guide);
    const Felt still = ask(*backend, pose);
    if (glm::length(still.wrench.force) < 1) continue;
    ++asked;
    const Felt felt = ask(little, pose);
    EXPECT_TRUE(felt.settled) << i;
    EXPECT_LT(felt.evaluations, LoneQuery::kMostEvaluations) << i;
    // A balance is found to a thousandth of the way, and the field is off by a tenth of that.
    EXPECT_LT(glm::length(felt.wrench.force - still.wrench.force),
              2e-3 * glm::length(still.wrench.force) + 1e-3)
        << i;
    lost += ask(much, pose).settled ? 0 : 1;
  }
  EXPECT_GT(asked, 5);
  EXPECT_GT(lost, asked / 2);
}

/// A field along x: a wall that holds the tool 20/3 mm from the device, and behind it another that would hold
/// it at 21 mm. At the device its planes say next to nothing of how the first one gives way.
TEST_F(OnContacts, OfTwoBalancesTheOneIsFoundThatAToolFromTheDeviceComesTo) {
  const auto field = [](double x) {
    const double near = 40e3 * std::max(0.0, 1e-3 - 0.1 * x),  // N: 40 at 0, none from 10 mm on
        far = x < 20e-3 ? 8e3 * std::max(0.0, x - 14e-3) : std::max(0.0, 48 - 6e3 * (x - 20e-3));
    ContactResponse out;
    out.contact = true;
    out.max_depth = 5e-3;
    out.wrench.force.x = near + far;
    out.planes.push_back({.normal = Vec3(1, 0, 0), .force = near + far, .stiffness = x == 0 ? 100.0 : 4e3});
    return out;
  };
  LoneQuery query(*geometry, kStiffness);
  ContactResponse here = field(0);
  query.begin(Pose{}, here);
  while (const std::optional<Pose> there = query.wanted()) query.take(field(there->position.x));
  query.felt(here);
  ASSERT_TRUE(here.felt);
  EXPECT_TRUE(here.felt->settled);
  EXPECT_NEAR(here.felt->tool.position.x, 20e-3 / 3, 1e-6);
  EXPECT_NEAR(here.felt->wrench.force.x, 40.0 / 3, 2e-3);
}

TEST_F(OnContacts, QueriesTogetherFindTheBalancesOfLoneQueriesInAsManyRoundsAsTheLongestTakes) {
  std::vector<Pose> poses;
  std::vector<ContactResponse> at_pose, together;
  for (std::size_t i = 0; i < 80; ++i) {
    poses.push_back(path_pose(scene->path[i * scene->path.size() / 80], scene->guide));
    const LatticePose lattice = *to_lattice(poses.back(), *geometry);
    ASSERT_TRUE(backend->query(lattice, nullptr, contacts));
    respond(contacts, lattice, *geometry, Profile::kRefined, kStiffness, at_pose.emplace_back());
  }
  together = at_pose;
  std::vector<ContactResponse*> told;
  for (ContactResponse& response : together) told.push_back(&response);
  Counting counting(*backend);
  LoneQueries queries(*geometry, kStiffness);
  ASSERT_TRUE(queries.feel(counting, poses, told));

  int longest = 0;
  std::size_t contacts_met = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ContactResponse alone = at_pose[i];
    ASSERT_TRUE(LoneQuery(*geometry, kStiffness).feel(*backend, nullptr, poses[i], alone));
    ASSERT_TRUE(alone.felt && together[i].felt) << i;
    const Felt &a = *alone.felt, &b = *together[i].felt;
    EXPECT_EQ(a.wrench.force, b.wrench.force) << i;
    EXPECT_EQ(a.wrench.torque, b.wrench.torque) << i;
    EXPECT_EQ(a.tool.position, b.tool.position) << i;
    EXPECT_EQ(a.tool.rotation, b.tool.rotation) << i;
    EXPECT_EQ(a.evaluations, b.evaluations) << i;
    EXPECT_EQ(a.settled, b.settled) << i;
    EXPECT_EQ(alone.flags, together[i].flags) << i;
    longest = std::max(longest, a.evaluations);
    contacts_met += at_pose[i].contact ? 1u : 0u;
  }
  EXPECT_GT(longest, 3);
  EXPECT_EQ(counting.alone, 0u);
  EXPECT_EQ(counting.rounds + 1, static_cast<std::size_t>(longest)) << "the pose itself was asked before";
  EXPECT_EQ(counting.most, contacts_met);
}

}  // namespace
}  // namespace palpate
