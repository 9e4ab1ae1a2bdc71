#include "driver/simulated_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "driver/device_list.h"
#include "driver/limits.h"
#include "driver/mass_spring.h"
#include "driver/path.h"
#include "model/lattice/rotation.h"
#include "tests/driver/allocation_count.h"

namespace palpate {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

std::unique_ptr<HapticDevice> make(const DeviceSettings& settings, const Pose& start = {},
                                   const Vec3& gc = Vec3(0)) {
  auto made = make_simulated_device(settings, start, gc);
  if (!made) {
    ADD_FAILURE() << made.error().sentence;
    return nullptr;
  }
  EXPECT_TRUE(made.value()->open());
  return std::move(made).value();
}

Vec3 gc_of(const Pose& pose, const Vec3& gc) { return pose.position + pose.rotation * gc; }

/// Writes the same wrench for `ticks` ticks, about the present gc, and gives the last pose.
Pose press(HapticDevice& device, const Wrench& wrench, int ticks, const Vec3& gc = Vec3(0)) {
  Pose pose = device.read().pose;
  for (int i = 0; i < ticks; ++i) {
    device.write(wrench, gc_of(pose, gc));
    pose = device.read().pose;
  }
  return pose;
}

/// A quarter circle of radius 0.5 m in the x-z plane, its frames turning with it, 200 pieces.
std::vector<GuidePoint> quarter_circle() {
  constexpr double kRadius = 0.5;
  std::vector<GuidePoint> guide;
  for (int i = 0; i <= 200; ++i) {
    const double angle = kPi / 2 * i / 200;
    guide.push_back({kRadius * angle,
                     {kRadius * Vec3(std::sin(angle), 0, 1 - std::cos(angle)), rotation_by({0, -angle, 0})}});
  }
  return guide;
}

DeviceSettings guided() {
  DeviceSettings settings;
  settings.guide = quarter_circle();
  settings.actuated = {true, false, false, true, true, true};
  settings.path.resize(1);
  settings.path[0].travel_m = 0.4;
  return settings;
}

TEST(MassSpring, OscillatesAsTheClosedFormSays) {
  // m = 2 kg, k = 50 N/m, no damping: y = cos(5 t); 1000 ticks of 1 ms, exact but for rounding.
  const MassSpring spring(2, 0, 50, 1e-3);
  double y = 1, velocity = 0;
  for (int i = 0; i < 1000; ++i) spring.step(y, velocity, 0.0);
  EXPECT_NEAR(y, std::cos(5.0), 1e-10);
  EXPECT_NEAR(velocity, -5 * std::sin(5.0), 1e-9);
}

TEST(MassSpring, FallsUnderAConstantForceWithoutASpring) {
  const MassSpring mass(0.5, 0, 0, 1e-3);
  double y = 0, velocity = 0;
  for (int i = 0; i < 2000; ++i) mass.step(y, velocity, 1.0);
  EXPECT_NEAR(y, 4.0, 1e-9);  // F t² / 2m = 1·4/1
}

TEST(MassSpring, StaysBoundedWhenTheSpringIsFarStifferThanTheTick) {
  const MassSpring stiff(0.01, 0.1, 1e9, 1e-3);  // ω T = 316, any explicit scheme explodes
  double y = 1, velocity = 0, largest = 0;
  for (int i = 0; i < 10000; ++i) {
    stiff.step(y, velocity, 0.0);
    largest = std::fmax(largest, std::abs(y));
  }
  EXPECT_LE(largest, 1.001);
}

TEST(Path, InterpolatesLinearlyAndTheShortWayRound) {
  std::vector<PathPoint> path(2);
  path[0].stage = 1;
  path[1].time_s = 2, path[1].pose = {Vec3(4, 0, 0), -rotation_by({0, 0, kPi / 2})},
  path[1].stage = 2;  // −q turns alike
  const PathPoint middle = path_at(path, 1);
  EXPECT_DOUBLE_EQ(middle.pose.position.x, 2);
  EXPECT_NEAR(rotation_vector(middle.pose.rotation).z, kPi / 4, 1e-14);
  EXPECT_EQ(middle.stage, 1);
  EXPECT_EQ(path_at(path, 2).stage, 2);
  EXPECT_DOUBLE_EQ(path_at(path, 99).pose.position.x, 4);
  EXPECT_DOUBLE_EQ(path_at(path, -1).pose.position.x, 0);
}

TEST(SimulatedDevice, RestsAtItsStartWithoutAPathOrForce) {
  const Pose start{Vec3(0.1, 0.2, 0.3), rotation_by({0.1, 0.2, 0.3})};
  auto device = make({}, start, Vec3(0.05, 0, 0));
  const Pose end = press(*device, {}, 1000, Vec3(0.05, 0, 0));
  EXPECT_LT(length(end.position - start.position), 1e-15);
}

TEST(SimulatedDevice, LagsAMovingHandByNothingButDevicesDamping) {
  // Constant speed: the hand's spring holds device damping × speed = 1 · 0.1 N, 0.1/135 m behind.
  DeviceSettings settings;
  settings.path.resize(2);
  settings.path[1].time_s = 10, settings.path[1].pose.position = Vec3(1, 0, 0);
  auto device = make(settings);
  const Pose pose = press(*device, {}, 5000);
  EXPECT_NEAR(pose.position.x, 0.5 - 0.1 / 135, 1e-9);
}

TEST(SimulatedDevice, YieldsToAForceByForceOverHandStiffness) {
  auto device = make({});
  EXPECT_NEAR(press(*device, {Vec3(0, 2.7, 0), Vec3(0)}, 5000).position.y, 2.7 / 135, 1e-9);
}

TEST(SimulatedDevice, YieldsToATorqueByTorqueOverAngularStiffness) {
  const Vec3 gc(0.02, 0.03, -0.01);
  auto device = make({}, {}, gc);
  const Pose pose = press(*device, {Vec3(0), Vec3(0, 0, 0.2)}, 5000, gc);
  EXPECT_NEAR(rotation_vector(pose.rotation).z, 0.2 / 2, 1e-9);
  EXPECT_LT(length(gc_of(pose, gc) - gc), 1e-12) << "a pure torque leaves the centre of mass where it is";
}

TEST(SimulatedDevice, TakesTheTorqueAboutWhateverPointItIsGiven) {
  // The same wrench, stated about gc and about a point 10 cm away.
  const Wrench about_gc{Vec3(0, 1, 0), Vec3(0, 0, 0.05)};
  auto a = make({}), b = make({});
  for (int i = 0; i < 500; ++i) {
    const Vec3 gc = a->read().pose.position, other = gc + Vec3(0.1, 0, 0);
    a->write(about_gc, gc);
    b->write(moved(about_gc, gc, other), other);
  }
  EXPECT_LT(length(a->read().pose.position - b->read().pose.position), 1e-14);
  EXPECT_LT(length(rotation_vector(a->read().pose.rotation * glm::conjugate(b->read().pose.rotation))),
            1e-13);
}

TEST(SimulatedDevice, ShortensForceAndTorqueToItsLimitsKeepingDirection) {
  DeviceSettings settings;
  settings.max_force_n = 5, settings.max_torque_nm = 0.1;
  auto device = make(settings);
  const Pose pose = press(*device, {Vec3(300, 400, 0), Vec3(0, 0, 50)}, 8000);
  EXPECT_NEAR(pose.position.x, 3.0 / 135, 1e-9);
  EXPECT_NEAR(pose.position.y, 4.0 / 135, 1e-9);
  EXPECT_NEAR(rotation_vector(pose.rotation).z, 0.1 / 2, 1e-9);
}

TEST(SimulatedDevice, DoesNotMoveAxesWithoutAMotor) {
  DeviceSettings settings;
  settings.actuated = {true, false, true, true, true, false};
  auto device = make(settings);
  const Pose pose = press(*device, {Vec3(1, 1, 1), Vec3(0, 0, 0.1)}, 2000);
  EXPECT_GT(pose.position.x, 1e-3);
  EXPECT_EQ(pose.position.y, 0);
  EXPECT_EQ(rotation_vector(pose.rotation), Vec3(0));
}

TEST(SimulatedDevice, IgnoresAWrenchThatIsNotFinite) {
  auto device = make({});
  EXPECT_EQ(press(*device, {Vec3(NAN, 0, 0), Vec3(0)}, 10).position, Vec3(0));
  EXPECT_EQ(press(*device, {Vec3(0), Vec3(0, INFINITY, 0)}, 10).position, Vec3(0));
}

/// Bends and turns about all axes, at uneven travels.
std::vector<GuidePoint> crooked_guide() {
  std::vector<GuidePoint> guide;
  const Vec3 turns[] = {{0, 0, 0}, {0.3, -0.2, 0.1}, {0.9, 0.4, -0.3}, {0.2, 1.1, 0.8}, {0.1, 1.1, 0.9}};
  const Vec3 places[] = {{0, 0, 0}, {0.1, 0, 0.02}, {0.15, 0.12, 0}, {0.1, 0.2, -0.1}, {0.1, 0.2, -0.2}};
  const double travels[] = {0, 0.1, 0.25, 0.3, 0.5};
  for (std::size_t i = 0; i < 5; ++i) guide.push_back({travels[i], {places[i], rotation_by(turns[i])}});
  return guide;
}

TEST(Guide, GoesThroughItsPoints) {
  const std::vector<GuidePoint> guide = crooked_guide();
  for (const GuidePoint& point : guide) {
    const Pose at = guide_at(guide, point.travel_m).frame;
    EXPECT_LT(length(at.position - point.frame.position), 1e-15);
    EXPECT_LT(length(rotation_vector(at.rotation * glm::conjugate(point.frame.rotation))), 1e-14);
  }
}

TEST(Guide, TangentAndTurningAreWhatItsFramesDo) {
  const std::vector<GuidePoint> guide = crooked_guide();
  constexpr double kStep = 1e-6;
  for (double travel = 0.0013; travel < 0.499; travel += 0.0037) {
    const GuideState at = guide_at(guide, travel), before = guide_at(guide, travel - kStep),
                     after = guide_at(guide, travel + kStep);
    // Central differences of something with third derivatives below 10^5 per m³, and their rounding.
    EXPECT_LT(length((after.frame.position - before.frame.position) / (2 * kStep) - at.tangent), 1e-6);
    EXPECT_LT(
        length(rotation_vector(after.frame.rotation * glm::conjugate(before.frame.rotation)) / (2 * kStep) -
               at.turning),
        1e-6)
        << "travel " << travel;
  }
}

TEST(Guide, TangentAndTurningDoNotJump) {
  // A force that is resolved along the guide would jump with them.
  const std::vector<GuidePoint> guide = crooked_guide();
  constexpr double kStep = 1e-9;  // over which they change by less than 10^4 per m times it
  for (std::size_t i = 1; i + 1 < guide.size(); ++i) {
    const GuideState before = guide_at(guide, guide[i].travel_m - kStep),
                     after = guide_at(guide, guide[i].travel_m + kStep);
    EXPECT_LT(length(after.tangent - before.tangent), 1e-5);
    EXPECT_LT(length(after.turning - before.turning), 1e-5);
  }
}

TEST(SimulatedDevice, MovesAlongItsGuideUnderTheForceAlongItAlone) {
  auto device = make(guided());
  const GuideState at = guide_at(guided().guide, 0.4);
  const Vec3 across = glm::cross(at.tangent, Vec3(0, 1, 0));
  const Pose start = device->read().pose;
  // Force at the pivot across the guide: its origin does not leave the place.
  EXPECT_LT(length(press(*device, {5.0 * across, Vec3(0)}, 2000).position - start.position), 1e-6);
  // Along it: travel grows by F/k; the arc's frames are the tangent's.
  Pose pose = device->read().pose;
  for (int i = 0; i < 6000; ++i) {
    device->write({1.35 * glm::normalize(guide_at(guided().guide, 0.4).tangent), Vec3(0)}, pose.position);
    pose = device->read().pose;
  }
  const double angle = std::atan2(pose.position.x, 0.5 - pose.position.z);
  EXPECT_NEAR(0.5 * angle, 0.4 + 0.01, 1e-4)
      << "1.35 N / 135 N/m = 10 mm of travel; force direction fixed, guide bends";
}

TEST(SimulatedDevice, IsPushedAlongABendByATorqueAboutItsAxis) {
  // The frame turns by −1/radius = −2 rad per metre about y, so −0.5 N·m about y pushes with 1 N along the
  // guide.
  DeviceSettings settings = guided();
  settings.hand_angular_stiffness_nm = 1e4;  // the hand holds the tool's rotation relative to the frame
  auto device = make(settings);
  const Pose pose = press(*device, {Vec3(0), Vec3(0, -0.5, 0)}, 6000);
  const double angle = std::atan2(pose.position.x, 0.5 - pose.position.z);
  EXPECT_NEAR(0.5 * angle, 0.4 + 1.0 / 135, 1e-6);
}

TEST(SimulatedDevice, ExertsOnItsGuideAWrenchOfTheSameWork) {
  // Power of the exertable part and of the whole wrench are the same for every motion that the rig allows.
  const Vec3 gc_tool(0.03, -0.02, 0.05);
  auto device = make(guided(), {}, gc_tool);
  const Pose pose = device->read().pose;
  const GuideState at = guide_at(guided().guide, 0.4);
  const Vec3 gc = pose.position + pose.rotation * gc_tool;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < 100; ++i) {
    const Wrench whole{any(), any()};
    const Wrench part = device->exertable(whole, gc);
    const double speed = normal(random);
    const Vec3 rate = any() + speed * at.turning;                                     // of the tool, world
    const Vec3 velocity = speed * at.tangent + glm::cross(rate, gc - pose.position);  // of gc
    EXPECT_NEAR(glm::dot(part.force, velocity) + glm::dot(part.torque, rate),
                glm::dot(whole.force, velocity) + glm::dot(whole.torque, rate), 1e-12);
    EXPECT_LT(length(glm::cross(part.force, at.tangent)), 1e-12) << "force along the guide only";
  }
}

TEST(SimulatedDevice, StopsHardAtTheEndOfItsGuide) {
  DeviceSettings settings = guided();
  settings.path[0].travel_m = 0.78;
  auto device = make(settings);
  Pose pose;
  for (int i = 0; i < 5000; ++i) {
    pose = device->read().pose;
    device->write({Vec3(0, 0, 15), Vec3(0)}, pose.position);
  }
  EXPECT_NEAR(pose.position.x, 0.5, 1e-9);  // the quarter circle's end
  EXPECT_NEAR(pose.position.z, 0.5, 1e-9);
}

TEST(SimulatedDevice, IsTheSameToTheBitEveryTime) {
  DeviceSettings settings = guided();
  PathPoint end{.time_s = 2, .pose = {Vec3(0), rotation_by({0.3, 0.2, 0.1})}, .travel_m = 0.6, .stage = 3};
  settings.path.push_back(end);
  const auto run = [&] {
    auto device = make(settings, {}, Vec3(0.01, 0.02, 0.03));
    return press(*device, {Vec3(1, 2, 3), Vec3(0.01, 0.02, 0.03)}, 1500, Vec3(0.01, 0.02, 0.03));
  };
  const Pose a = run(), b = run();
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.rotation, b.rotation);
}

TEST(SimulatedDevice, DoesNotAllocateInATick) {
  auto device = make(guided());
  const std::size_t before = allocations_of_this_thread();
  for (int i = 0; i < 100; ++i) {
    const DeviceSample sample = device->read();
    device->write(device->exertable({Vec3(1), Vec3(0.1)}, sample.pose.position), sample.pose.position);
  }
  EXPECT_EQ(allocations_of_this_thread(), before);
}

TEST(SimulatedDevice, TellsVirtualTimeStageAndState) {
  DeviceSettings settings;
  settings.path.resize(2);
  settings.path[0].stage = 1;
  settings.path[1].time_s = 0.01, settings.path[1].stage = 2;
  auto made = make_simulated_device(settings, {}, Vec3(0));
  ASSERT_TRUE(made);
  HapticDevice& device = **made;
  EXPECT_EQ(device.read().state, DeviceState::kClosed);
  ASSERT_TRUE(device.open());
  EXPECT_EQ(device.read().stage, 1);
  press(device, {}, 10);
  EXPECT_EQ(device.read().stage, 2);
  EXPECT_EQ(device.read().time_ns, 10'000'000);
  device.close();
  EXPECT_EQ(device.read().state, DeviceState::kClosed);
}

TEST(SimulatedDevice, RefusesSettingsThatMakeNoSenseInOneSentence) {
  const auto refusal = [](const DeviceSettings& settings) {
    auto made = make_simulated_device(settings, {}, Vec3(0));
    return made ? std::string("accepted") : made.error().sentence;
  };
  DeviceSettings settings;
  settings.mass_kg = 0;
  EXPECT_THAT(refusal(settings), HasSubstr("mass (kg) is 0.000000"));
  settings = {};
  settings.hand_stiffness_n_per_m = NAN;
  EXPECT_THAT(refusal(settings), HasSubstr("hand stiffness"));
  settings = {};
  settings.path.resize(2);
  settings.path[0].time_s = 1, settings.path[1].time_s = 0.5;
  EXPECT_THAT(refusal(settings), HasSubstr("path point 1"));
  settings = {};
  settings.guide.resize(1);
  EXPECT_THAT(refusal(settings), HasSubstr("at least 2 points"));
  settings.guide.resize(2);
  EXPECT_THAT(refusal(settings), HasSubstr("guide point 1"));
}

TEST(DeviceList, SaysWhatItCannotDriveInsteadOfPretending) {
  EXPECT_TRUE(make_haptic_device("simulated", {}, {}, Vec3(0)));
  auto replay = make_haptic_device("replay", {}, {}, Vec3(0));
  ASSERT_FALSE(replay);
  EXPECT_EQ(replay.error().code, ErrorCode::kBadValue);
  EXPECT_THAT(replay.error().sentence, HasSubstr("needs a recorded trace"));
  auto unknown = make_haptic_device("falcom", {}, {}, Vec3(0));
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kUsage);
  EXPECT_THAT(unknown.error().sentence, HasSubstr("falcon"));
}

}  // namespace
}  // namespace palpate
