// The safety wrapper's promises, kept for every device that palpate drives: what reaches the device is looked
// at between the two.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <thread>

#include "driver/inverse3/inverse3_device.h"
#include "driver/limits.h"
#include "driver/replay/replay_device.h"
#include "driver/safe_device.h"
#include "driver/simulated_device.h"
#include "driver/spacemouse/report.h"
#include "driver/spacemouse/spacemouse_device.h"
#include "tests/driver/fake_usb/falcon_table.h"
#include "tests/driver/inverse3_service.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// A device, and what reached it. Its state can be overruled.
class Spy final : public HapticDevice {
 public:
  explicit Spy(std::unique_ptr<HapticDevice> device) : device_(std::move(device)) {}
  std::string name() const override { return device_->name(); }
  DeviceCapabilities capabilities() const override { return device_->capabilities(); }
  Result<void> open() override { return device_->open(); }
  void close() noexcept override {
    closed_at_zero = last.force == Vec3(0) && last.torque == Vec3(0);
    device_->close();
  }
  DeviceSample read() noexcept override {
    DeviceSample sample = device_->read();
    if (overruled) sample.state = *overruled;
    return sample;
  }
  Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept override {
    return device_->exertable(wrench, gc);
  }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    last = wrench;
    device_->write(wrench, gc);
  }

  Wrench last{Vec3(9), Vec3(9)};
  bool closed_at_zero = false;
  std::optional<DeviceState> overruled;

 private:
  std::unique_ptr<HapticDevice> device_;
};

/// A device by name, with all that it stands on.
class AnyDevice : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string name = GetParam();
    std::unique_ptr<HapticDevice> made;
    if (name == "simulated") made = std::move(make_simulated_device({}, Pose{}, Vec3(0))).value();
    if (name == "falcon") {
      falcon_ = std::make_unique<fake::FalconTable>(fake::FalconFaults{}, true);
      made = std::move(falcon::make_falcon({}, Pose{}, falcon_->opener())).value();
    }
    if (name == "spacemouse") {
      mouse_ = std::make_unique<fake::DescriptorFront>(
          fake::DeviceCalls{[](std::uint8_t, std::uint16_t) { return true; },
                            [](std::span<const std::uint8_t>) {}, [] { return std::vector<std::uint8_t>{}; },
                            [] { return false; }},
          fake::hid_descriptors(0x256f, 0xc62e));
      made = spacemouse::make_spacemouse(
          {}, Pose{}, [this] { return UsbPort::open_descriptor(mouse_->descriptor(), 0); });
    }
    if (name == "inverse3") {
      service_ = std::make_unique<fake::Inverse3Service>();
      made = inverse3::make_inverse3({.port = service_->port()}, Pose{});
    }
    if (name == "replay") {
      const std::string file = testing::TempDir() + "any_device_" + std::to_string(::getpid()) + ".csv";
      std::ofstream(file) << "time_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n";
      made = std::move(replay::make_replay(file, 20, 2)).value();
      std::filesystem::remove(file);
    }
    ASSERT_TRUE(made);
    spy_ = std::make_unique<Spy>(std::move(made));
  }
  /// Ticks, pushing, until the device is ready; nothing may get through before.
  void until_ready(SafeDevice& safe) {
    for (int i = 0; i < 20'000; ++i) {
      if (safe.read().state == DeviceState::kReady) return;
      safe.fresh();
      safe.write(kPush, Vec3(0));
      ASSERT_EQ(spy_->last.force, Vec3(0)) << "force before the device is ready";
      std::this_thread::sleep_for(1ms);
    }
    FAIL() << "never ready";
  }
  void tick(SafeDevice& safe, const Wrench& wrench, bool fresh = true) {
    (void)safe.read();
    if (fresh) safe.fresh();
    safe.write(wrench, Vec3(0));
  }
  bool exerts() const { return spy_->capabilities().max_force_n > 0; }

  const Wrench kPush{Vec3(0, 0, 2), Vec3(0)};
  static constexpr SafetySettings kSettings{.fade_in_ticks = 10, .watchdog_ticks = 20, .fade_out_ticks = 20};
  std::unique_ptr<fake::FalconTable> falcon_;
  std::unique_ptr<fake::DescriptorFront> mouse_;
  std::unique_ptr<fake::Inverse3Service> service_;
  std::unique_ptr<Spy> spy_;
};

TEST_P(AnyDevice, NothingBeyondItsLimitsOrAxesReachesIt) {
  SafeDevice safe(*spy_, kSettings);
  ASSERT_TRUE(safe.open());
  until_ready(safe);
  const DeviceCapabilities can = spy_->capabilities();
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> decades(-3, 300);
  double strongest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double size = std::pow(10.0, decades(random));
    tick(safe, {size * Vec3(normal(random), normal(random), normal(random)),
                size * Vec3(normal(random), normal(random), normal(random))});
    if (safe.faulted()) break;  // a size beyond the largest double is no force
    strongest = std::max(strongest, length(spy_->last.force));
    ASSERT_LE(length(spy_->last.force), can.max_force_n * (1 + 1e-12));
    ASSERT_LE(length(spy_->last.torque), can.max_torque_nm * (1 + 1e-12));
    for (int axis = 0; axis < 3; ++axis) {
      if (!can.actuated[static_cast<std::size_t>(axis)]) {
        ASSERT_EQ(spy_->last.force[axis], 0);
      }
      if (!can.actuated[static_cast<std::size_t>(axis) + 3]) {
        ASSERT_EQ(spy_->last.torque[axis], 0);
      }
    }
  }
  EXPECT_EQ(strongest > 0, exerts());
}

TEST_P(AnyDevice, WithoutFreshResultsItsForceEndsWithinTheWatchdogAndItsFade) {
  SafeDevice safe(*spy_, kSettings);
  ASSERT_TRUE(safe.open());
  until_ready(safe);
  for (int i = 0; i < 50; ++i) tick(safe, kPush);
  EXPECT_EQ(spy_->last.force != Vec3(0), exerts());
  for (int i = 0; i < kSettings.watchdog_ticks + kSettings.fade_out_ticks; ++i) tick(safe, kPush, false);
  EXPECT_EQ(spy_->last.force, Vec3(0));
}

TEST_P(AnyDevice, InAnyStateButReadyAndAfterAnyErrorItGetsZero) {
  for (const DeviceState state : {DeviceState::kClosed, DeviceState::kOpening, DeviceState::kLoading,
                                  DeviceState::kHoming, DeviceState::kFault}) {
    SafeDevice safe(*spy_, kSettings);
    ASSERT_TRUE(safe.open());
    until_ready(safe);
    for (int i = 0; i < 50; ++i) tick(safe, kPush);
    spy_->overruled = state;
    tick(safe, kPush);
    EXPECT_EQ(spy_->last.force, Vec3(0));
    spy_->overruled.reset();
    for (int i = 0; i < 5; ++i) tick(safe, kPush);
    if (state == DeviceState::kFault) {
      EXPECT_EQ(spy_->last.force, Vec3(0)) << "a fault stays until it is opened anew";
    }
    tick(safe, {Vec3(NAN, 0, 0), Vec3(0)});
    tick(safe, kPush);
    EXPECT_TRUE(safe.faulted());
    EXPECT_EQ(spy_->last.force, Vec3(0));
  }
}

TEST_P(AnyDevice, ItIsLeftAtZeroWhateverEndsTheWrapper) {
  {
    SafeDevice safe(*spy_, kSettings);
    ASSERT_TRUE(safe.open());
    until_ready(safe);
    for (int i = 0; i < 50; ++i) tick(safe, kPush);
  }
  EXPECT_TRUE(spy_->closed_at_zero);
  if (falcon_) {
    EXPECT_EQ(falcon_->locked([&] { return falcon_->model.motors(); }), falcon::MotorCounts{})
        << "as its motors saw it";
  }
}

INSTANTIATE_TEST_SUITE_P(Driven, AnyDevice,
                         testing::Values("simulated", "falcon", "inverse3", "spacemouse", "replay"),
                         [](const auto& param) { return std::string(param.param); });

}  // namespace
}  // namespace palpate
