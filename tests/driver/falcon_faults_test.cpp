// Every fault in every state of the Falcon: what comes of it. The device on the far side is a model, libusb
// is the real one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <mutex>
#include <thread>

#include "driver/falcon/report_filter.h"
#include "tests/driver/fake_usb/falcon_table.h"
#include "tests/model/temporary_folder.h"

namespace palpate::falcon {
namespace {

using namespace std::chrono_literals;
using fake::FalconTable;
using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

constexpr MotorCounts kNone{0, 0, 0};
constexpr int kForever = 1'000'000'000;
constexpr auto kHang = 90s;  // no time-out of the driver's is near it, whatever the machine is busy with

enum class Outcome {
  kRefused,  ///< open() fails
  kReady,    ///< is ready, or becomes so, and force arrives
  kAway,     ///< kOpening: it is looked for
  kHoming,   ///< waits to be homed
  kFault,
};

constexpr std::array kStates{DeviceState::kClosed, DeviceState::kOpening, DeviceState::kLoading,
                             DeviceState::kHoming, DeviceState::kReady};
constexpr std::array kStateNames{"closed", "opening", "loading", "homing", "ready"};

struct Row {
  const char* fault;
  std::function<void(FalconTable&)> strike;  ///< called with the front's lock free
  std::array<Outcome, 5> outcomes;           ///< for kStates
  const char* guidance = "";                 ///< a part of what is said at a fault
  bool slow = false;                         ///< by the driver's time-outs: seconds
};

/// Changes the model with its lock held.
auto model_fault(std::function<void(fake::FalconModel&)> change) {
  return [change](FalconTable& table) { table.locked([&] { change(table.model); }); };
}

std::vector<Row> rows() {
  using enum Outcome;
  constexpr std::array kAllReady{kReady, kReady, kReady, kReady, kReady};
  constexpr std::array kAllFault{kFault, kFault, kFault, kFault, kFault};
  constexpr std::array kAllAway{kAway, kAway, kAway, kAway, kAway};
  return {
      {"nothing", [](FalconTable&) {}, kAllReady},
      {"stall of IN, thrice", [](FalconTable& t) { t.front->faults.stalled_in = 3; }, kAllReady},
      {"stall of IN, for ever", [](FalconTable& t) { t.front->faults.stalled_in = kForever; }, kAllAway},
      {"stall of OUT, thrice", [](FalconTable& t) { t.front->faults.stalled_out = 3; }, kAllReady},
      {"stall of OUT, for ever", [](FalconTable& t) { t.front->faults.stalled_out = kForever; }, kAllFault,
       "sending the greeting"},
      {"refused requests, twice", [](FalconTable& t) { t.front->faults.stalled_control = 2; }, kAllReady},
      {"refused requests, for ever",
       [](FalconTable& t) { t.front->faults.stalled_control = kForever; },
       {kFault, kFault, kFault, kReady, kReady},
       "did not load: setting the line for the greeting"},
      {"babble, thrice", [](FalconTable& t) { t.front->faults.babble = 3; }, kAllReady},
      {"babble, for ever", [](FalconTable& t) { t.front->faults.babble = kForever; }, kAllAway},
      {"short reports", model_fault([](auto& m) { m.faults.short_every = 3; }), kAllReady},
      {"split reports", model_fault([](auto& m) { m.faults.splits = true; }), kAllReady},
      {"merged reports", model_fault([](auto& m) { m.faults.merges = 2; }), kAllReady},
      {"corrupt reports", model_fault([](auto& m) { m.faults.corrupt_every = 3; }), kAllReady},
      {"stray bytes", model_fault([](auto& m) { m.faults.stray_every = 2; }), kAllReady},
      {"silence", model_fault([](auto& m) { m.faults.silent = true; }), kAllFault,
       "loaded to the end, and then silent, 10 attempts"},
      {"wrong echo, once",
       model_fault([](auto& m) { m.faults.wrong_echo_at = 100, m.faults.wrong_echoes = 1; }), kAllReady},
      {"wrong echo, for ever",
       model_fault([](auto& m) { m.faults.wrong_echo_at = 100; }),
       {kFault, kFault, kFault, kReady, kReady},
       "the echo of chunk 2 of 5 differs, 10 attempts"},
      {"flaky loads", model_fault([](auto& m) { m.faults.bad_loads = 2; }), kAllReady},
      {"greetings ignored", model_fault([](auto& m) { m.faults.greetings_ignored = 5; }), kAllReady},
      {"deaf to the greeting",
       model_fault([](auto& m) { m.faults.deaf_to_greeting = true; }),
       {kFault, kFault, kFault, kReady, kReady},
       "the greeting was not answered (100 tries), 10 attempts",
       true},
      {"deaf to the new baud rate",
       model_fault([](auto& m) { m.faults.deaf_to_baud = true; }),
       {kFault, kFault, kFault, kReady, kReady},
       "the new baud rate was not answered, 10 attempts",
       true},
      {"encoders off from the start",
       model_fault([](auto& m) { m.faults.jump_at = 0; }),
       {kHoming, kHoming, kHoming, kHoming, kFault},
       "encoders keep jumping"},
      {"encoders jump, once",
       model_fault([](auto& m) { m.faults.jump_at = m.reports() + 20, m.faults.jump_reports = 1; }),
       kAllReady},
      {"homing lost", model_fault([](auto& m) { m.lose_homing(); }), kAllReady},
      {"never homed", model_fault([](auto& m) { m.lose_homing(), m.faults.never_homed = 1; }), kAllFault,
       "was not homed in time"},
      // Half of what the driver waits for the answer to a greeting: a busy machine adds its own.
      {"slow bus, 10 ms", [](FalconTable& t) { t.front->faults.slow_us = 10'000; }, kAllReady},
      {"deaf bus", [](FalconTable& t) { t.front->faults.deaf = true; }, kAllFault, "sending the greeting",
       true},
      {"unplugged", [](FalconTable& t) { t.unplug(); }, {kRefused, kAway, kAway, kAway, kAway}},
      {"unplugged and plugged in", [](FalconTable& t) { t.unplug(), t.model.power_cycle(), t.plug(); },
       kAllReady},
      {"in use elsewhere",
       [](FalconTable& t) { t.front->faults.busy = true; },
       {kRefused, kAway, kReady, kReady, kReady}},
  };
}

std::string firmware_file() {
  static const TemporaryFolder folder;
  const std::string path = folder.path("firmware.bin");
  std::ofstream out(path, std::ios::binary);
  for (std::size_t i = 0; i < FalconTable::kFirmwareBytes; ++i) out.put(static_cast<char>(i * 37));
  return path;
}

/// The control loop: pushes all the time, and reads. Until `done` says so, or a hang. The state that it ended
/// in.
template <class Done>
DeviceState push_until(HapticDevice& device, Done done) {
  for (const auto end = Clock::now() + kHang; Clock::now() < end;) {
    const DeviceState state = device.read().state;
    if (done(state)) return state;
    device.write({Vec3(0, 0, 2), Vec3(0)}, Vec3(0));
    std::this_thread::sleep_for(1ms);
  }
  ADD_FAILURE() << "a hang";
  return device.read().state;
}

auto is(DeviceState wanted) {
  return [wanted](DeviceState state) { return state == wanted; };
}

/// One cell: a device in a state, struck by a fault.
void strike(const Row& row, std::size_t column, const std::string& firmware) {
  SCOPED_TRACE(std::string(row.fault) + " while " + kStateNames[column]);
  FalconTable table;
  FalconSettings settings;
  settings.firmware = firmware;
  settings.homing_timeout_s = row.outcomes[column] == Outcome::kFault ? 3 : 60;
  auto made = make_falcon(settings, Pose{}, table.opener());
  ASSERT_TRUE(made);
  HapticDevice& device = **made;
  const DeviceState state = kStates[column];
  const auto change = [&](auto what) { table.locked([&] { what(table.model); }); };

  // Into the state, and held there.
  const auto opened = [&] { return device.open(); };
  if (state != DeviceState::kClosed) {
    if (state == DeviceState::kLoading) change([](auto& m) { m.faults.deaf_to_greeting = true; });
    if (state == DeviceState::kHoming) change([](auto& m) { m.homes_after = kForever; });
    ASSERT_TRUE(opened());
    if (state == DeviceState::kOpening) table.unplug();
    push_until(device, is(state));
  }
  if (state == DeviceState::kReady)
    push_until(device, [&](auto) { return table.locked([&] { return table.model.motors() != kNone; }); });

  // The fault, and free to go on. What is away comes back with the fault on it, unless the fault is to be
  // away.
  const bool stays_away = state == DeviceState::kOpening && std::string_view(row.fault) == "unplugged";
  if (state == DeviceState::kOpening && !stays_away) {
    table.model.power_cycle();
    table.plug(false);
  }
  if (!stays_away) row.strike(table);
  if (state == DeviceState::kOpening && !stays_away) table.plugged = true;
  change([&](auto& m) {
    if (state == DeviceState::kLoading && std::string_view(row.fault) != "deaf to the greeting")
      m.faults.deaf_to_greeting = false;
    if (state == DeviceState::kHoming) m.homes_after = 50;
  });

  if (state == DeviceState::kClosed) {
    const auto begun = opened();
    EXPECT_EQ(bool(begun), row.outcomes[column] != Outcome::kRefused);
    if (!begun) {
      EXPECT_EQ(begun.error().code, ErrorCode::kNoDevice);
      return;
    }
  }

  // What comes of it.
  switch (row.outcomes[column]) {
    case Outcome::kRefused:
      ADD_FAILURE() << "only a closed device is refused";
      break;
    case Outcome::kReady: {
      // Long enough for the fault to have struck, then force must flow.
      const int from = table.locked([&] { return table.model.reports(); });
      push_until(device, [&](DeviceState now) {
        return now == DeviceState::kReady && table.locked([&] {
          return table.model.reports() > from + 100 && table.model.motors() != kNone;
        });
      });
      EXPECT_EQ(device.read().state, DeviceState::kReady);
      break;
    }
    case Outcome::kAway:
      push_until(device, is(DeviceState::kOpening));
      for (int i = 0; i < 300; ++i) {  // and stays so, or is tried again
        EXPECT_NE(device.read().state, DeviceState::kReady);
        std::this_thread::sleep_for(1ms);
      }
      break;
    case Outcome::kHoming: {
      push_until(device, [&](DeviceState now) {
        return now == DeviceState::kHoming && table.locked([&] { return table.model.homed(); });
      });
      const int from = table.locked([&] { return table.model.reports(); });
      push_until(device, [&](DeviceState) {
        return table.locked([&] { return table.model.reports() > from + 100; });
      });
      EXPECT_EQ(device.read().state, DeviceState::kHoming);
      EXPECT_THAT(device.guidance(), HasSubstr("what its arms can't do"));
      break;
    }
    case Outcome::kFault:
      push_until(device, is(DeviceState::kFault));
      EXPECT_THAT(device.guidance(), HasSubstr(row.guidance));
      break;
  }
  // Lost homing is believed once as many reports in a row say so as the driver asks for; until then the
  // loop's force goes out.
  const bool lost = state == DeviceState::kReady && (std::string_view(row.fault) == "homing lost" ||
                                                     std::string_view(row.fault) == "never homed");
  EXPECT_LE(table.forces_unhomed, lost ? kAgreeingReports : 0) << "force without homing";
  device.close();
  EXPECT_EQ(device.read().state, DeviceState::kClosed);
  const bool reachable = table.plugged && !table.front->faults.deaf && table.front->faults.stalled_out == 0;
  if (reachable) {
    EXPECT_EQ(table.locked([&] { return table.model.motors(); }), kNone) << "force is left on";
  }
}

std::ptrdiff_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

/// Runs jobs on a few threads: they wait most of the time.
void in_parallel(const std::vector<std::function<void()>>& jobs) {
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> workers;
  for (int i = 0; i < 8; ++i)
    workers.emplace_back([&] {
      for (std::size_t job = next++; job < jobs.size(); job = next++) jobs[job]();
    });
  for (std::thread& worker : workers) worker.join();
}

TEST(FalconFaults, EveryFaultInEveryStateHasItsOutcome) {
  const bool slow_too = std::getenv("PALPATE_SLOW_FAULTS") != nullptr;
  const std::string firmware = firmware_file();
  const std::vector<Row> all = rows();
  const auto before = threads();
  std::vector<std::function<void()>> jobs;
  for (const bool slow : {true, false})  // the long ones first, so that they end together
    for (const Row& row : all)
      if (row.slow == slow && (slow_too || !slow))
        for (std::size_t column = 0; column < kStates.size(); ++column)
          jobs.emplace_back([&row, column, &firmware] { strike(row, column, firmware); });
  in_parallel(jobs);
  EXPECT_EQ(threads(), before) << "a thread is left";
  std::printf("%zu cells\n", jobs.size());
}

TEST(FalconFaults, UnpluggedAtEveryTransferFromTheFirstToContactItComesBack) {
  const std::string firmware = firmware_file();
  const auto before = threads();
  std::vector<std::function<void()>> jobs;
  std::atomic<int> in_contact{0};
  for (int transfer = 1; transfer <= 400; transfer += transfer < 120 ? 1 : 7)
    jobs.emplace_back([&, transfer] {
      SCOPED_TRACE("unplugged at transfer " + std::to_string(transfer));
      FalconTable table;
      table.model.homes_after = 20;
      FalconSettings settings;
      settings.firmware = firmware;
      auto made = make_falcon(settings, Pose{}, table.opener());
      ASSERT_TRUE(made);
      HapticDevice& device = **made;
      table.front->faults.unplug_in = transfer;
      const bool opened = bool(device.open());
      if (opened) {
        DeviceState last = DeviceState::kClosed;
        push_until(device, [&](DeviceState state) {
          if (state == DeviceState::kOpening && table.front->faults.unplug_in == 0) return true;
          last = state;
          return false;
        });
        in_contact += last == DeviceState::kReady;
      }
      // In again: the same way from the start.
      table.locked([&] { table.model.power_cycle(); });
      table.plug();
      if (!opened) {
        ASSERT_TRUE(device.open());
      }
      push_until(device, [&](DeviceState state) {
        return state == DeviceState::kReady && table.locked([&] { return table.model.motors() != kNone; });
      });
      EXPECT_EQ(table.forces_unhomed, 0);
      device.close();
      EXPECT_EQ(table.locked([&] { return table.model.motors(); }), kNone);
    });
  in_parallel(jobs);
  EXPECT_GT(in_contact, 0) << "some of them in contact";
  EXPECT_EQ(threads(), before) << "a thread is left";
  std::printf("%zu points, %d of them in contact\n", jobs.size(), in_contact.load());
}

}  // namespace
}  // namespace palpate::falcon
