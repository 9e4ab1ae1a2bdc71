// The Falcon driver against a model of the device, through the real libusb.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <thread>

#include "driver/device_notes.h"
#include "driver/falcon/falcon_device.h"
#include "driver/falcon/firmware.h"
#include "driver/safe_device.h"
#include "tests/driver/fake_usb/falcon_table.h"
#include "tests/model/temporary_folder.h"

namespace palpate::falcon {
namespace {

using namespace std::chrono_literals;
using fake::FalconFaults;

/// With a firmware of many chunks.
struct Table : fake::FalconTable {
  explicit Table(FalconFaults faults = {}, bool loaded = false) : FalconTable(faults, loaded, 1000) {}
};

std::string firmware_file(std::size_t size) {
  static const TemporaryFolder folder;
  const std::string path = folder.path("firmware.bin");
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 0; i < size; ++i) out.put(static_cast<char>(i * 37 + i / 256));
  return path;
}

/// Ticks until the device is in a state; false if it never is.
bool reaches(HapticDevice& device, DeviceState wanted, std::chrono::milliseconds patience = 20s) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < end) {
    if (device.read().state == wanted) return true;
    device.write({}, Vec3(0));
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

FalconSettings with_firmware() {
  FalconSettings settings;
  settings.firmware = firmware_file(1000);
  return settings;
}

TEST(Falcon, IsLoadedHomedAndExertsForce) {
  Table table;
  auto made = make_falcon(with_firmware(), Pose{}, table.opener());
  ASSERT_TRUE(made) << made.error().sentence;
  HapticDevice& device = **made;
  ASSERT_TRUE(device.open());
  ASSERT_TRUE(reaches(device, DeviceState::kReady));
  EXPECT_EQ(table.front->locked([&] { return table.model.firmware().size(); }), 1000U);
  // At the centre a force along z loads the three motors alike.
  for (int i = 0; i < 100; ++i) {
    device.read();
    device.write({Vec3(0, 0, 2), Vec3(0)}, Vec3(0));
    std::this_thread::sleep_for(1ms);
  }
  const MotorCounts motors = table.front->locked([&] { return table.model.motors(); });
  EXPECT_NE(motors[0], 0);
  EXPECT_NEAR(motors[1], motors[0], 1);
  EXPECT_NEAR(motors[2], motors[0], 1);
  device.close();
  EXPECT_EQ(table.front->locked([&] { return table.model.motors(); }), (MotorCounts{0, 0, 0}))
      << "closing ends force";
}

/// Pushes along z for a while and says what arrived at the motors last.
MotorCounts pushed(HapticDevice& device, Table& table, int ticks = 50) {
  for (int i = 0; i < ticks; ++i) {
    device.read();
    device.write({Vec3(0, 0, 2), Vec3(0)}, Vec3(0));
    std::this_thread::sleep_for(1ms);
  }
  return table.front->locked([&] { return table.model.motors(); });
}

constexpr MotorCounts kNone{0, 0, 0};

TEST(Falcon, AFirmwareThatRunsAlreadyIsNotLoadedAgain) {
  Table table({}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  EXPECT_TRUE(reaches(**made, DeviceState::kReady));
  EXPECT_EQ(table.model.loads(), 0);
}

TEST(Falcon, WithoutFirmwareItSaysSo) {
  Table table;
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kFault));
  EXPECT_EQ(std::string((*made)->guidance()), "the Falcon runs no firmware; name its file with --firmware");
}

TEST(Falcon, FlakyLoadingIsRetried) {
  FalconFaults faults;
  faults.bad_loads = 2;
  faults.leads_with_zero = true;
  faults.greetings_ignored = 5;
  Table table(faults);
  auto made = make_falcon(with_firmware(), Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  EXPECT_TRUE(reaches(**made, DeviceState::kReady));
  EXPECT_EQ(table.front->locked([&] { return table.model.loads(); }), 3);
}

TEST(Falcon, FirmwareFilesThatAreNoneAreRefused) {
  FalconSettings settings;
  settings.firmware = "/nowhere/firmware.bin";
  auto made = make_falcon(settings, Pose{}, nullptr);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kBadValue);
  settings.firmware = firmware_file(0);
  made = make_falcon(settings, Pose{}, nullptr);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().sentence.find("is empty"), std::string::npos);
  settings.firmware = firmware_file(kLargestFirmware + 1);
  made = make_falcon(settings, Pose{}, nullptr);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().sentence.find("longer than 1048576 bytes"), std::string::npos);
}

TEST(Falcon, AHomingThatNeverEndsIsAFaultWithoutForce) {
  FalconFaults faults;
  faults.never_homed = 1;
  Table table(faults, true);
  FalconSettings settings;
  settings.homing_timeout_s = 0.3;
  auto made = make_falcon(settings, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kHoming));
  EXPECT_EQ(pushed(**made, table), kNone) << "no force before homing";
  EXPECT_TRUE(reaches(**made, DeviceState::kFault));
}

TEST(Falcon, UnpluggedInContactItGivesNoForceUntilHomedAnew) {
  Table table;
  auto made = make_falcon(with_firmware(), Pose{}, table.opener());
  ASSERT_TRUE(made);
  HapticDevice& device = **made;
  ASSERT_TRUE(device.open());
  ASSERT_TRUE(reaches(device, DeviceState::kReady));
  ASSERT_NE(pushed(device, table), kNone);
  table.unplug();
  ASSERT_TRUE(reaches(device, DeviceState::kOpening, 2s));
  table.model.power_cycle();
  table.plug();
  ASSERT_TRUE(reaches(device, DeviceState::kHoming));
  EXPECT_EQ(pushed(device, table, 5), kNone);
  ASSERT_TRUE(reaches(device, DeviceState::kReady));
  EXPECT_NE(pushed(device, table), kNone);
}

TEST(Falcon, ASilentLoopLosesItsForce) {
  Table table({}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  ASSERT_NE(pushed(**made, table), kNone);
  // The control loop stops calling. The bound is the link's 20 ms; the wait is longer only for a busy
  // machine's sake.
  std::this_thread::sleep_for(500ms);
  EXPECT_EQ(table.front->locked([&] { return table.model.motors(); }), kNone);
}

TEST(Falcon, EncodersThatJumpEndForce) {
  FalconFaults faults;
  faults.jump_at = 400;
  Table table(faults, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  const auto end = std::chrono::steady_clock::now() + 20s;
  while ((*made)->read().state != DeviceState::kFault && std::chrono::steady_clock::now() < end)
    pushed(**made, table, 1);
  EXPECT_EQ((*made)->read().state, DeviceState::kFault);
  EXPECT_EQ(pushed(**made, table), kNone);
}

TEST(Falcon, AJumpOfOneReportIsNotFelt) {
  FalconFaults faults;
  faults.jump_at = 300;
  faults.jump_reports = 1;
  Table table(faults, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  const Vec3 rest = (*made)->read().pose.position;
  while (table.front->locked([&] { return table.model.reports(); }) < 400) {
    const DeviceSample sample = (*made)->read();
    EXPECT_EQ(sample.state, DeviceState::kReady);
    EXPECT_EQ(sample.pose.position, rest);
    (*made)->write({}, Vec3(0));
    std::this_thread::sleep_for(1ms);
  }
}

/// Damaged bytes: the device stays ready and at rest, and force still arrives.
void stays_usable(const FalconFaults& faults) {
  Table table(faults, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  const Vec3 rest = (*made)->read().pose.position;
  for (int i = 0; i < 20; ++i) {
    EXPECT_NE(pushed(**made, table, 10), kNone);
    EXPECT_EQ((*made)->read().pose.position, rest);
    EXPECT_EQ((*made)->read().state, DeviceState::kReady);
  }
}

TEST(Falcon, WhatHappenedOnTheBusIsToldAfterwards) {
  Table table({.corrupt_every = 3}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  pushed(**made, table);
  table.front->faults.stalled_in = 2;
  pushed(**made, table);
  (*made)->close();
  const auto* told = dynamic_cast<const DeviceNotes*>(made->get());
  ASSERT_TRUE(told);
  ASSERT_EQ(told->notes().size(), 1u);
  EXPECT_NE(told->notes()[0].find("; 2 bus errors"), std::string::npos) << told->notes()[0];
  EXPECT_EQ(told->notes()[0].find(" 0 more were malformed"), std::string::npos) << told->notes()[0];
  EXPECT_EQ(told->notes()[0].find(" 0 came late"), std::string::npos)
      << "a broken report is no answer: " << told->notes()[0];
}

TEST(Falcon, ShortReportsAreSurvived) { stays_usable({.short_every = 3}); }
TEST(Falcon, CorruptReportsAreSurvived) { stays_usable({.corrupt_every = 3}); }
TEST(Falcon, StrayBytesAreSurvived) { stays_usable({.stray_every = 2}); }
TEST(Falcon, SplitReportsAreSurvived) { stays_usable({.splits = true}); }
TEST(Falcon, MergedReportsAreSurvived) { stays_usable({.merges = 2}); }

TEST(Falcon, StallsAndBabbleOnTheBusAreSurvived) {
  Table table({}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  table.front->faults.stalled_in = 3;
  table.front->faults.stalled_out = 2;
  EXPECT_NE(pushed(**made, table), kNone);
  table.front->faults.babble = 3;
  EXPECT_NE(pushed(**made, table), kNone);
  EXPECT_EQ((*made)->read().state, DeviceState::kReady);
}

TEST(Falcon, ASilentDeviceIsBroughtUpAnew) {
  FalconFaults faults;
  faults.reports_silent_after = 300;
  Table table(faults, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  ASSERT_TRUE((*made)->open());
  ASSERT_TRUE(reaches(**made, DeviceState::kReady));
  const auto end = std::chrono::steady_clock::now() + 20s;
  while ((*made)->read().state == DeviceState::kReady && std::chrono::steady_clock::now() < end)
    pushed(**made, table, 1);
  EXPECT_NE((*made)->read().state, DeviceState::kReady);
  EXPECT_EQ(pushed(**made, table), kNone);
}

TEST(Falcon, ADeviceInUseIsRefusedInOneSentence) {
  Table table;
  table.front->faults.busy = true;
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  const auto opened = (*made)->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::kNoDevice);
  EXPECT_EQ(opened.error().sentence, "falcon: USB device 0403:cb48 is in use by another program");
}

TEST(Falcon, UnpluggedAtAnyPointOfLoadingItNeitherHangsNorCrashes) {
  for (int after_ms = 0; after_ms < 60; after_ms += 4) {
    Table table;
    auto made = make_falcon(with_firmware(), Pose{}, table.opener());
    ASSERT_TRUE(made);
    ASSERT_TRUE((*made)->open());
    std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
    table.unplug();
    EXPECT_TRUE(reaches(**made, DeviceState::kOpening, 5s)) << after_ms;
    (*made)->close();
  }
}

TEST(Falcon, ASafeDeviceRoundItFadesInAfterHoming) {
  Table table({}, true);
  auto made = make_falcon({}, Pose{}, table.opener());
  ASSERT_TRUE(made);
  SafeDevice safe(**made, {});
  ASSERT_TRUE(safe.open());
  ASSERT_TRUE(reaches(safe, DeviceState::kReady));
  safe.fresh();
  safe.write({Vec3(0, 0, 100), Vec3(0)}, Vec3(0));
  EXPECT_GT(safe.sent().force.z, 0);
  EXPECT_LE(safe.sent().force.z, 8.0) << "the device's rating";
}

}  // namespace
}  // namespace palpate::falcon
