// The SpaceMouse's own thread, through the real libusb.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <filesystem>
#include <glm/glm.hpp>
#include <mutex>
#include <thread>

#include "driver/spacemouse/report.h"
#include "driver/spacemouse/spacemouse_device.h"
#include "tests/driver/fake_usb/descriptor_front.h"

namespace palpate::spacemouse {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;
constexpr double kFullSpeed = 0.1 * 1e-3;  // m a tick, RateSettings

Bytes axes_report(std::uint8_t number, const std::vector<int>& values) {
  Bytes bytes{number};
  for (const int value : values) {
    bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>((value >> 8) & 0xFF));
  }
  return bytes;
}

/// A SpaceMouse on a table, and what its ring of light was told.
class Table {
 public:
  explicit Table(UsbId id = kModels.front()) : id_(id) { plug(); }
  void plug() {
    const std::lock_guard lock(mutex_);
    if (front) drawer_.push_back(std::move(front));
    front = std::make_unique<fake::DescriptorFront>(
        fake::DeviceCalls{
            [](std::uint8_t, std::uint16_t) { return true; }, [](std::span<const std::uint8_t>) {},
            [this] {
              if (reports_.empty()) return Bytes{};
              Bytes report = reports_.front();
              reports_.pop_front();
              return report;
            },
            [this] { return !reports_.empty(); },
            [this](std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data) {
              if (request == 9 && value == 0x0204) light.assign(data.begin(), data.end());
            }},
        fake::hid_descriptors(id_.vendor, id_.product));
    plugged_ = true;
  }
  void unplug() {
    plugged_ = false;
    front->unplug();
  }
  void say(const Bytes& report) {
    front->locked([&] { reports_.push_back(report); });
  }
  OpenPort opener() {
    return [this]() -> Result<std::unique_ptr<UsbPort>> {
      const std::lock_guard lock(mutex_);
      if (!plugged_) return Error{ErrorCode::kNoDevice, "nothing is plugged in"};
      return UsbPort::open_descriptor(front->descriptor(), 0);
    };
  }

  std::unique_ptr<fake::DescriptorFront> front;
  Bytes light;

 private:
  UsbId id_;
  std::mutex mutex_;
  std::deque<Bytes> reports_;
  std::vector<std::unique_ptr<fake::DescriptorFront>> drawer_;
  std::atomic<bool> plugged_{false};
};

/// Reads until a condition on the sample holds; a failure if it never does.
template <class Condition>
DeviceSample sample_when(HapticDevice& device, Condition condition) {
  DeviceSample sample;
  for (int i = 0; i < 20'000; ++i) {
    sample = device.read();
    if (condition(sample)) return sample;
    std::this_thread::sleep_for(1ms);
  }
  ADD_FAILURE() << "it never came";
  return sample;
}

/// Says where the cap is, and a button so that the report's arrival is seen.
void push(Table& table, HapticDevice& device, const std::vector<Bytes>& reports, std::uint8_t mark) {
  for (const Bytes& report : reports) table.say(report);
  table.say({3, mark, 0});
  sample_when(device, [&](const DeviceSample& sample) { return sample.buttons == mark; });
}

/// How far the tool goes in a tick.
Vec3 step_of(HapticDevice& device) {
  const Vec3 before = device.read().pose.position;
  return device.read().pose.position - before;
}

TEST(SpaceMouse, EveryModelSteersInBothFormsOfReport) {
  for (const UsbId id : kModels) {
    SCOPED_TRACE(id.product);
    Table table(id);
    auto device = make_spacemouse({}, Pose{}, table.opener());
    ASSERT_TRUE(device->open());
    EXPECT_EQ(table.front->locked([&] { return table.light; }), (Bytes{4, 1})) << "the ring is lit";
    push(table, *device, {axes_report(1, {350, 0, -350}), axes_report(2, {0, 0, 350})},
         1);  // older: two reports
    EXPECT_NEAR(glm::length(step_of(*device) - Vec3(kFullSpeed, 0, -kFullSpeed)), 0, 1e-15);
    const Quat before = device->read().pose.rotation, after = device->read().pose.rotation;
    const Quat turn = after * glm::conjugate(before);
    EXPECT_NEAR(2 * std::atan2(turn.z, turn.w), 1e-3, 1e-9) << "1 rad/s about z";
    push(table, *device, {axes_report(1, {0, 350, 0, 0, 0, 0})}, 2);  // newer: one
    EXPECT_NEAR(glm::length(step_of(*device) - Vec3(0, kFullSpeed, 0)), 0, 1e-15);
    push(table, *device, {axes_report(1, {0, 0, 0, 0, 0, 0})}, 3);
    EXPECT_EQ(step_of(*device), Vec3(0));
  }
}

TEST(SpaceMouse, ScaleAxesAndClutchOfTheWorkspaceHold) {
  Table table;
  SpaceMouseSettings settings;
  settings.workspace.scale = 0.5;
  settings.workspace.axes = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};  // world x is the cap's z
  settings.workspace.clutch_buttons = 4;
  auto device = make_spacemouse(settings, Pose{}, table.opener());
  ASSERT_TRUE(device->open());
  push(table, *device, {axes_report(1, {0, 0, 350, 0, 0, 0})}, 1);
  EXPECT_NEAR(glm::length(step_of(*device) - Vec3(0.5 * kFullSpeed, 0, 0)), 0, 1e-15);
  push(table, *device, {}, 4);
  EXPECT_TRUE(device->read().clutched);
  EXPECT_EQ(step_of(*device), Vec3(0));
}

TEST(SpaceMouse, UnpluggedItRestsAndIsFoundAgain) {
  Table table;
  auto device = make_spacemouse({}, Pose{}, table.opener());
  ASSERT_TRUE(device->open());
  push(table, *device, {axes_report(1, {350, 0, 0, 0, 0, 0})}, 1);
  table.unplug();
  sample_when(*device, [](const DeviceSample& sample) { return sample.state == DeviceState::kOpening; });
  EXPECT_EQ(step_of(*device), Vec3(0)) << "a cap that is gone does not go on pushing";
  EXPECT_STREQ(device->guidance(), "the SpaceMouse is gone; plug it in again");
  table.plug();
  sample_when(*device, [](const DeviceSample& sample) { return sample.state == DeviceState::kReady; });
  EXPECT_STREQ(device->guidance(), "");
  EXPECT_EQ(step_of(*device), Vec3(0));
  push(table, *device, {axes_report(1, {350, 0, 0, 0, 0, 0})}, 2);
  EXPECT_NE(step_of(*device), Vec3(0));
}

TEST(SpaceMouse, StallsAndBabbleAreSurvivedAndEndlessOnesMeanItIsGone) {
  Table table;
  auto device = make_spacemouse({}, Pose{}, table.opener());
  ASSERT_TRUE(device->open());
  table.front->faults.stalled_in = 3;
  push(table, *device, {axes_report(1, {350, 0, 0, 0, 0, 0})}, 1);
  table.front->faults.babble = 3;
  push(table, *device, {axes_report(1, {0, 0, 0, 0, 0, 0})}, 2);
  EXPECT_EQ(device->read().state, DeviceState::kReady);
  table.front->faults.stalled_in = 1'000'000'000;
  sample_when(*device, [](const DeviceSample& sample) { return sample.state == DeviceState::kOpening; });
}

TEST(SpaceMouse, OneInUseIsRefusedAndNoThreadIsLeft) {
  const auto threads = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/task"),
                         std::filesystem::directory_iterator());
  };
  const auto before = threads();
  {
    Table table;
    table.front->faults.busy = true;
    auto device = make_spacemouse({}, Pose{}, table.opener());
    const auto opened = device->open();
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().code, ErrorCode::kNoDevice);
    EXPECT_THAT(opened.error().sentence, testing::HasSubstr("in use by another program"));
    table.front->faults.busy = false;
    ASSERT_TRUE(device->open());
    device->close();
    ASSERT_TRUE(device->open());
  }
  EXPECT_EQ(threads(), before);
}

}  // namespace
}  // namespace palpate::spacemouse
