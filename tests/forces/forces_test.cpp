// What a force must be where parts fit: its way, no net force where sides cancel, couples that right, no
// steps, no work from round trips (docs/ACCURACY.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "compute/native/native_backend.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/force/force_judge.h"

namespace palpate {
namespace {

bool all() { return std::getenv("PALPATE_ALL_FORCES") != nullptr; }

/// Cases that each rest on something else, for every change.
constexpr std::array kQuick{"peg of 24 sides tilted, play 0.3 mm",
                            "peg of 96 sides off centre askew, play 0.05 mm",
                            "peg of 24 sides round its hole, play 0.3 mm",
                            "press fit of 48 sides",
                            "square peg yawed",
                            "key yawed in its keyway",
                            "tongue between walls",
                            "gears of 20 and 12 teeth",
                            "bracket, leg at 0.1 mm, voxels of 1 mm",
                            "box off a table",
                            "plate on to 2 pads",
                            "thin tool on a thick block",
                            "pin on a plate",
                            "thin plate whose faces do not meet on a pin",
                            "cone's tip on a block",
                            "sheet from below",
                            "open box from outside",
                            "block in an open box",
                            "open box round a block"};

/// What runs, chosen beforehand: nothing is skipped.
std::vector<ForceCaseMaker> asked_cases() {
  std::vector<ForceCaseMaker> cases = force_cases();
  if (all()) return cases;
  std::erase_if(cases, [](const ForceCaseMaker& maker) {
    return std::ranges::find(kQuick, maker.name) == kQuick.end();
  });
  if (cases.size() != kQuick.size()) throw std::logic_error("a quick case is no case of the judge");
  return cases;
}

class Forces : public testing::TestWithParam<ForceCaseMaker> {};

TEST_P(Forces, AreAsThePartsSay) {
  const auto backend = make_native_backend();
  const ForceCase subject = GetParam().make();
  for (const double voxels : all() ? std::vector{1.0, 0.5, 2.0} : std::vector{1.0}) {
    const Result<ForceFigures> figures = judge_force(subject, *backend, Profile::kRefined, voxels);
    ASSERT_TRUE(figures) << figures.error().sentence;
    EXPECT_GT(figures->touching, 0u);
    for (const std::string& sentence : figures->broken)
      ADD_FAILURE() << subject.name << ", voxels × " << voxels << ": " << sentence;
  }
}

std::string test_name(const testing::TestParamInfo<ForceCaseMaker>& info) {
  std::string out;
  for (const char c : info.param.name) out += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return out;
}

INSTANTIATE_TEST_SUITE_P(Cases, Forces, testing::ValuesIn(asked_cases()), test_name);

TEST(OpenBodies, PushWithoutAStepWhereTheirInsideBeginsWithoutASurface) {
  // A rod goes up a pin that lacks its lower end, 0.1 mm out of the pin's side all along, so that they touch.
  // Eight voxels of 2 mm from that end the pin's inside begins.
  Mesh pin = solids::box(Vec3(0), Vec3(0.003, 0.003, 0.048), Int3(1));
  std::erase_if(pin.triangles, [&](const auto& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return pin.vertices[v].z == 0; });
  });
  pin.parts = {{"pin", 0, static_cast<std::uint32_t>(pin.triangles.size())}};
  ASSERT_EQ(pin.triangles.size(), 10u);
  const Mesh rod = solids::box(Vec3(-0.0008, -0.0008, -0.03), Vec3(0.0008, 0.0008, 0), Int3(1));
  ForceCase subject{.name = "rod up an open pin", .mockup = {}, .tool = {}, .path = {}};
  constexpr int kPoses = 800;
  for (int i = 0; i <= kPoses; ++i)
    subject.path.push_back({Vec3(0.0023, 0.0015, 0.0153 + 0.0015 * i / kPoses), Quat(1, 0, 0, 0)});
  GeometrySettings settings;
  settings.voxel_size_m = 0.002;
  const auto geometry = build_geometry(pin, rod, settings);
  ASSERT_TRUE(geometry);
  const auto backend = make_native_backend();
  ASSERT_TRUE(backend->prepare(*geometry, Plan{}, {}));
  const Result<ForceFigures> figures =
      judge_path(subject, *geometry, *backend, Profile::kRefined, kForceStiffness);
  ASSERT_TRUE(figures) << figures.error().sentence;
  EXPECT_GT(figures->touching, 0u);
  EXPECT_GT(figures->force_n.back(), figures->force_n.front());  // the inside was reached
  EXPECT_LT(figures->largest_step, kMostStep);
}

TEST(ForceJudge, SeesAStepAndALossThatAreThere) {
  // A tool pushed through a thin plate lets go in a step: the judge must see it once the case no longer says
  // so.
  const auto backend = make_native_backend();
  for (const ForceCaseMaker& maker : force_cases()) {
    if (maker.name != "plate of 0.4 mm pierced") continue;
    ForceCase subject = maker.make();
    subject.slips = false;
    const Result<ForceFigures> figures = judge_force(subject, *backend, Profile::kRefined);
    ASSERT_TRUE(figures) << figures.error().sentence;
    EXPECT_GT(figures->largest_step, kMostStep);
    EXPECT_FALSE(figures->broken.empty());
    return;
  }
  FAIL() << "no such case";
}

TEST(ForceJudge, TellsAHandFromLonePosesWhereAWallHasTwoSides) {
  // A cube pulled through a wall of 4 mm: past the wall's middle a lone pose is pushed out on the far side,
  // and a hand that came from above still stands on it, with K times its way.
  const Mesh wall = solids::box(Vec3(-0.05, -0.05, -0.002), Vec3(0.05, 0.05, 0.002), Int3(20, 20, 2)),
             cube = solids::box(Vec3(-0.005), Vec3(0.005), Int3(6, 6, 6));
  ForceCase subject{.name = "cube through a wall", .mockup = {}, .tool = {}, .path = {}};
  constexpr int kPoses = 50;
  for (int i = 0; i <= kPoses; ++i)
    subject.path.push_back({Vec3(0.001, 0.002, 0.0075 - 0.0105 * i / kPoses), Quat(1, 0, 0, 0)});
  const auto geometry = build_geometry(wall, cube, {});
  ASSERT_TRUE(geometry);
  const auto backend = make_native_backend();
  ASSERT_TRUE(backend->prepare(*geometry, Plan{}, {}));
  Result<ForceFigures> figures = judge_path(subject, *geometry, *backend, Profile::kRefined, kForceStiffness);
  ASSERT_TRUE(figures) << figures.error().sentence;
  EXPECT_FALSE(figures->hand_step.has_value());
  ASSERT_TRUE(judge_hand(subject, *geometry, *backend, kForceStiffness, StartContacts::kAsIs, *figures));
  EXPECT_GE(figures->reversals, 1u);
  EXPECT_GT(figures->largest_step, kMostStep);
  EXPECT_EQ(figures->hand_reversals, 0u);
  EXPECT_GT(*figures->hand_step, 0.5);
  // A spring before a wall is no stiffer than the spring. Balances are found to a thousandth of 10 mm of way,
  // which is a twentieth of a step.
  EXPECT_LT(*figures->hand_step, 1.05);
  EXPECT_EQ(figures->unsettled, 0u);
}

TEST(ForceJudge, LeavesOutForAHandWhatTouchesAtTheStartUntilItHasOpened) {
  const Mesh wall = solids::box(Vec3(-0.05, -0.05, -0.02), Vec3(0.05, 0.05, 0), Int3(20, 20, 4)),
             cube = solids::box(Vec3(-0.005), Vec3(0.005), Int3(6, 6, 6));
  const auto geometry = build_geometry(wall, cube, {});
  ASSERT_TRUE(geometry);
  const auto backend = make_native_backend();
  ASSERT_TRUE(backend->prepare(*geometry, Plan{}, {}));
  // Half a millimetre in the wall, and on.
  ForceCase subject{.name = "cube in a wall", .mockup = {}, .tool = {}, .path = {}};
  const auto go = [&](double from_mm, double to_mm) {
    constexpr int kPoses = 20;
    for (int i = 0; i <= kPoses; ++i)
      subject.path.push_back(
          {Vec3(0.001, 0.002, 0.005 + 1e-3 * (from_mm + (to_mm - from_mm) * i / kPoses)), Quat(1, 0, 0, 0)});
  };
  const auto hand_step = [&](StartContacts start) {
    ForceFigures figures;
    EXPECT_TRUE(judge_hand(subject, *geometry, *backend, kForceStiffness, start, figures));
    return figures.hand_step.value_or(-1);
  };
  // The cube's face is 64 A_ref, so the wall is 64 times as stiff as the spring. Balances as above.
  constexpr double kFelt = 64.0 / 65, kBalance = 0.05;
  go(-0.5, -2);
  EXPECT_NEAR(hand_step(StartContacts::kAsIs), kFelt, kBalance);
  EXPECT_EQ(hand_step(StartContacts::kIgnoreInitial), 0);
  // Out and in again.
  go(-2, 1);
  go(1, -1);
  EXPECT_NEAR(hand_step(StartContacts::kIgnoreInitial), kFelt, kBalance);
}

}  // namespace
}  // namespace palpate
