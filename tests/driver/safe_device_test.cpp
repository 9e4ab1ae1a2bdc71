#include "driver/safe_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "driver/limits.h"

namespace palpate {
namespace {

/// A device that remembers what reached it.
class FakeDevice : public HapticDevice {
 public:
  std::string name() const override { return "fake"; }
  DeviceCapabilities capabilities() const override { return can; }
  Result<void> open() override { return {}; }
  void close() noexcept override { closed_after = last; }
  DeviceSample read() noexcept override { return {.pose = pose, .state = state, .clutched = clutched}; }
  const char* guidance() const noexcept override { return says; }
  void write(const Wrench& wrench, const Vec3&) noexcept override { last = wrench, ++writes; }

  DeviceCapabilities can{
      .actuated = {true, true, true, true, true, true}, .max_force_n = 10, .max_torque_nm = 1};
  Pose pose;
  DeviceState state = DeviceState::kReady;
  Wrench last{Vec3(99), Vec3(99)}, closed_after{Vec3(99), Vec3(99)};
  int writes = 0;
  bool clutched = false;
  const char* says = "";
};

constexpr SafetySettings kAtOnce{.fade_in_ticks = 0, .watchdog_ticks = 0};
const Wrench kPush{Vec3(1, 2, 2), Vec3(0.1, 0, 0)};

void tick(SafeDevice& safe, const Wrench& wrench) {
  safe.read();
  safe.fresh();
  safe.write(wrench, Vec3(0));
}

TEST(SafeDevice, LetsASafeWrenchThroughUnchanged) {
  FakeDevice device;
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, kPush.force);
  EXPECT_EQ(device.last.torque, kPush.torque);
}

TEST(SafeDevice, ShortensToTheLimitsKeepingDirection) {
  FakeDevice device;
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  tick(safe, {Vec3(30, 0, 40), Vec3(0, 3, 4)});
  EXPECT_NEAR(length(device.last.force - Vec3(6, 0, 8)), 0, 1e-14);
  EXPECT_NEAR(length(device.last.torque - Vec3(0, 0.6, 0.8)), 0, 1e-15);
  EXPECT_EQ(safe.saturated_ticks(), 1u);
  tick(safe, {Vec3(1e308, 1e308, 0), Vec3(0)});
  EXPECT_NEAR(length(device.last.force), 10, 1e-9)
      << "a length beyond the largest double is no way round the limit";
}

TEST(SafeDevice, SendsOnlyActuatedAxesAndLeavesTheirLimitToThem) {
  FakeDevice device;
  device.can.actuated = {true, false, false, false, false, true};
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  tick(safe, {Vec3(5, 100, 0), Vec3(3, 0, 0.5)});
  EXPECT_EQ(device.last.force, Vec3(5, 0, 0));
  EXPECT_EQ(device.last.torque, Vec3(0, 0, 0.5));
}

TEST(SafeDevice, GivesNoForceToADeviceThatStatesNoLimit) {
  FakeDevice device;
  device.can.max_force_n = 0, device.can.max_torque_nm = NAN;
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, Vec3(0));
  EXPECT_EQ(device.last.torque, Vec3(0));
}

TEST(SafeDevice, SendsZeroUntilTheDeviceIsReadyAndFadesInAfterwards) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 4, .watchdog_ticks = 0});
  ASSERT_TRUE(safe.open());
  for (const DeviceState state : {DeviceState::kOpening, DeviceState::kLoading, DeviceState::kHoming}) {
    device.state = state;
    for (int i = 0; i < 10; ++i) tick(safe, kPush);
    EXPECT_EQ(device.last.force, Vec3(0));
  }
  device.state = DeviceState::kReady;
  for (int i = 1; i <= 4; ++i) {
    tick(safe, kPush);
    EXPECT_NEAR(device.last.force.x, 0.25 * i, 1e-15);
  }
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, kPush.force);
  device.state = DeviceState::kHoming;  // homed anew: zero at once, then from the start
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, Vec3(0));
  device.state = DeviceState::kReady;
  tick(safe, kPush);
  EXPECT_NEAR(device.last.force.x, 0.25, 1e-15);
}

TEST(SafeDevice, AClutchedHandFeelsNothingAndForceFadesInAfterwards) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 4, .watchdog_ticks = 0});
  ASSERT_TRUE(safe.open());
  for (int i = 0; i < 10; ++i) tick(safe, kPush);
  device.clutched = true;
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, Vec3(0)) << "the tool stays behind: its force would push a free hand";
  device.clutched = false;
  tick(safe, kPush);
  EXPECT_NEAR(device.last.force.x, 0.25, 1e-15);
}

TEST(SafeDevice, AFaultIsToldInTheDevicesOwnWords) {
  FakeDevice device;
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  device.says = "the fake is broken";
  device.state = DeviceState::kFault;
  tick(safe, kPush);
  EXPECT_STREQ(safe.fault(), "the fake is broken");
  EXPECT_STREQ(safe.guidance(), "the fake is broken");
}

TEST(SafeDevice, LatchesAWrenchThatIsNotFiniteAsAFault) {
  for (const Wrench& bad : {Wrench{Vec3(NAN, 0, 0), Vec3(0)}, Wrench{Vec3(0), Vec3(0, 0, INFINITY)}}) {
    FakeDevice device;
    SafeDevice safe(device, kAtOnce);
    ASSERT_TRUE(safe.open());
    tick(safe, kPush);
    tick(safe, bad);
    EXPECT_EQ(device.last.force, Vec3(0));
    EXPECT_TRUE(safe.faulted());
    tick(safe, kPush);
    EXPECT_EQ(device.last.force, Vec3(0)) << "a fault stays";
    EXPECT_EQ(safe.read().state, DeviceState::kFault);
    ASSERT_TRUE(safe.open());
    tick(safe, kPush);
    EXPECT_EQ(device.last.force, kPush.force) << "until the device is opened anew";
  }
}

TEST(SafeDevice, LatchesAPoseThatIsNoneAndReportsTheLastSoundOne) {
  FakeDevice device;
  device.pose.position = Vec3(1, 2, 3);
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  tick(safe, kPush);
  device.pose.position.y = NAN;
  const DeviceSample sample = safe.read();
  EXPECT_EQ(sample.state, DeviceState::kFault);
  EXPECT_EQ(sample.pose.position, Vec3(1, 2, 3));
  safe.write(kPush, Vec3(0));
  EXPECT_EQ(device.last.force, Vec3(0));
  EXPECT_THAT(safe.fault(), testing::HasSubstr("pose"));
}

TEST(SafeDevice, LatchesTheDevicesOwnFault) {
  FakeDevice device;
  SafeDevice safe(device, kAtOnce);
  ASSERT_TRUE(safe.open());
  device.state = DeviceState::kFault;
  tick(safe, kPush);
  device.state = DeviceState::kReady;
  tick(safe, kPush);
  EXPECT_EQ(device.last.force, Vec3(0));
  EXPECT_TRUE(safe.faulted());
}

TEST(SafeDevice, FadesToZeroWithoutFreshResultsAndBackInWithThem) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 2, .watchdog_ticks = 5, .fade_out_ticks = 4});
  ASSERT_TRUE(safe.open());
  for (int i = 0; i < 10; ++i) tick(safe, kPush);
  EXPECT_EQ(safe.gain(), 1);
  double before = 1;
  const auto stale = [&] { safe.read(), safe.write(kPush, Vec3(0)); };
  for (int i = 0; i < 4; ++i) stale();  // the last fresh() still covers 5 writes, one is used
  EXPECT_EQ(safe.gain(), 1);
  for (int i = 0; i < 4; ++i) {
    stale();
    EXPECT_LT(safe.gain(), before);
    before = safe.gain();
  }
  EXPECT_EQ(device.last.force, Vec3(0));
  EXPECT_EQ(safe.watchdog_ticks(), 4u);
  tick(safe, kPush);
  EXPECT_EQ(safe.gain(), 0.5);
}

TEST(SafeDevice, WritesZeroBeforeItClosesTheDevice) {
  FakeDevice device;
  {
    SafeDevice safe(device, kAtOnce);
    ASSERT_TRUE(safe.open());
    tick(safe, kPush);
    safe.close();
    EXPECT_EQ(device.closed_after.force, Vec3(0));
    const int writes = device.writes;
    tick(safe, kPush);
    EXPECT_EQ(device.writes, writes) << "a closed device is left alone";
  }
}

TEST(SafeDevice, WritesZeroAndClosesWhenItGoesAway) {
  FakeDevice device;
  {
    SafeDevice safe(device, kAtOnce);
    ASSERT_TRUE(safe.open());
    tick(safe, kPush);
  }
  EXPECT_EQ(device.closed_after.force, Vec3(0));
  EXPECT_EQ(device.closed_after.torque, Vec3(0));
}

TEST(SafeDevice, StartsFromZeroAgainWhenTold) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 4, .watchdog_ticks = 0});
  ASSERT_TRUE(safe.open());
  for (int i = 0; i < 10; ++i) tick(safe, kPush);
  safe.restart_fade();
  tick(safe, kPush);
  EXPECT_EQ(safe.gain(), 0.25);
}

TEST(SafeDevice, ChangesForceAndTorqueNoFasterThanTheSlewLimitBothWays) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 0, .watchdog_ticks = 0, .slew_ticks = 5});
  ASSERT_TRUE(safe.open());
  Wrench before;
  for (int i = 0; i < 40; ++i) {
    const double sign = i % 20 < 10 ? 1 : -1;
    tick(safe, {Vec3(0, 0, 100 * sign), Vec3(0.2 * sign, 0, 0)});
    EXPECT_LE(length(device.last.force - before.force), 2 + 1e-12) << "10 N in 5 ticks";
    EXPECT_LE(length(device.last.torque - before.torque), 0.2 + 1e-12);
    before = device.last;
    if (i == 9) {
      EXPECT_NEAR(before.force.z, 10, 1e-12);
    }
  }
  EXPECT_GT(safe.slewed_ticks(), 0u);
}

TEST(SafeDevice, IsAtZeroAtOnceWhateverTheSlewLimit) {
  const SafetySettings slow{.fade_in_ticks = 0, .watchdog_ticks = 3, .fade_out_ticks = 4, .slew_ticks = 1000};
  {
    FakeDevice device;
    SafeDevice safe(device, slow);
    ASSERT_TRUE(safe.open());
    for (int i = 0; i < 500; ++i) tick(safe, kPush);
    EXPECT_GT(device.last.force.z, 1);
    device.state = DeviceState::kFault;
    tick(safe, kPush);
    EXPECT_EQ(device.last.force, Vec3(0));
  }
  FakeDevice device;
  SafeDevice safe(device, slow);
  ASSERT_TRUE(safe.open());
  for (int i = 0; i < 500; ++i) tick(safe, kPush);
  for (int i = 0; i < 8; ++i) safe.read(), safe.write(kPush, Vec3(0));  // no fresh result
  EXPECT_EQ(device.last.force, Vec3(0)) << "the watchdog's fade is not held up";
}

/// A hand of 0.2 kg on a wall that makes energy: it pushes back harder on the way out than on the way in.
/// Returns the wall's work, J.
double work_of_an_active_wall(bool passivity) {
  FakeDevice device;
  device.can.max_force_n = 100;
  SafeDevice safe(device, {.fade_in_ticks = 0, .watchdog_ticks = 0, .passivity = passivity});
  EXPECT_TRUE(safe.open());
  double x = 1e-3, v = -0.1, work = 0;
  for (int i = 0; i < 3000; ++i) {
    device.pose.position.z = x;
    safe.read();
    safe.write({Vec3(0, 0, x < 0 ? (v > 0 ? -520 : -500) * x : 0), Vec3(0)}, device.pose.position);
    const double push = device.last.force.z;
    const double next = x + v * 1e-3 + 0.5 * (push - 1) / 0.2 * 1e-6;  // the hand presses with 1 N
    work += push * (next - x);
    v += (push - 1) / 0.2 * 1e-3;
    x = next;
  }
  return work;
}

TEST(SafeDevice, TakesBackTheEnergyThatAWallMakesWhenPassivityIsOn) {
  EXPECT_GT(work_of_an_active_wall(false), 1e-3);
  EXPECT_LT(work_of_an_active_wall(true), 1e-5);
}

TEST(SafeDevice, LeavesAPassiveWallAloneWhenPassivityIsOn) {
  FakeDevice device;
  SafeDevice safe(device, {.fade_in_ticks = 0, .watchdog_ticks = 0, .passivity = true});
  ASSERT_TRUE(safe.open());
  for (int i = 0; i < 300; ++i) {  // a damper: takes energy only
    device.pose.position.z = 1e-3 * std::sin(0.05 * i);
    tick(safe, {Vec3(0, 0, -0.05 * std::cos(0.05 * i)), Vec3(0)});
    ASSERT_EQ(device.last.force.z, -0.05 * std::cos(0.05 * i)) << i;
  }
  EXPECT_EQ(safe.damped_ticks(), 0u);
}

}  // namespace
}  // namespace palpate
