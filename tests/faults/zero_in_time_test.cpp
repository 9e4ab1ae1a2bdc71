// However a run goes wrong, the device itself sees the force end in time. It counts: writes on the simulated
// device, whose bound holds on the busiest machine, for the watchdog counts the same writes; and packets
// behind the real libusb on a model of the Falcon.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "driver/safe_device.h"
#include "driver/simulated_device.h"
#include "service/cli/console.h"
#include "service/loop/session.h"
#include "tests/driver/fake_usb/falcon_table.h"
#include "tests/service/half_space.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr int kWatchdogTicks = 20;                       // a scene's default
const int kFadeTicks = SafetySettings{}.fade_out_ticks;  // the watchdog's own

enum class Loss { kDevice, kInterrupt, kTerminate, kException, kStall };
constexpr Loss kLosses[] = {Loss::kDevice, Loss::kInterrupt, Loss::kTerminate, Loss::kException,
                            Loss::kStall};
const char* name_of(Loss loss) {
  switch (loss) {
    case Loss::kDevice:
      return "compute_device_lost";
    case Loss::kInterrupt:
      return "sigint";
    case Loss::kTerminate:
      return "sigterm";
    case Loss::kException:
      return "exception_in_the_worker";
    case Loss::kStall:
      return "stalled_worker";
  }
  return "";
}
void PrintTo(Loss loss, std::ostream* out) { *out << name_of(loss); }

/// What the two sides of a run know of each other.
struct Trial {
  explicit Trial(Loss what) : loss(what) { catch_interrupts(); }
  const Loss loss;
  std::atomic<bool> now{false};    ///< it is to go wrong
  std::atomic<bool> wrong{false};  ///< it has
  std::atomic<bool> over{false};   ///< the run has ended: a stalled worker may go on
  int number() const { return loss == Loss::kInterrupt ? SIGINT : SIGTERM; }
  bool signals() const { return loss == Loss::kInterrupt || loss == Loss::kTerminate; }
};

/// A half-space, until it goes wrong.
HalfSpace failing(Trial& trial) {
  HalfSpace backend;
  backend.on_query = [&trial](int) -> Result<void> {
    if (!trial.now || trial.signals()) return {};
    trial.wrong = true;
    if (trial.loss == Loss::kDevice) return Error{ErrorCode::kInternal, "the device was lost"};
    if (trial.loss == Loss::kException) throw std::runtime_error("bad luck");
    while (!trial.over) std::this_thread::sleep_for(1ms);
    return {};
  };
  return backend;
}

LoadedScene pressed() {
  LoadedScene scene = half_space_scene();
  scene.scene.start.position.z = -0.005;  // 5 N
  scene.scene.control.watchdog_ms = kWatchdogTicks;
  return scene;
}

class ZeroInTime : public testing::TestWithParam<Loss> {};
INSTANTIATE_TEST_SUITE_P(Each, ZeroInTime, testing::ValuesIn(kLosses),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

/// The simulated device; sets the trial off after a hundred writes with force, and counts those that come
/// afterwards.
class CountingDevice final : public HapticDevice {
 public:
  CountingDevice(const LoadedScene& scene, Trial& trial) : trial_(trial) {
    auto made = make_simulated_device(scene.scene.device, scene.scene.start, Vec3(0));
    if (!made) throw std::runtime_error(made.error().sentence);
    device_ = std::move(made).value();
  }
  std::string name() const override { return "simulated"; }
  DeviceCapabilities capabilities() const override { return device_->capabilities(); }
  Result<void> open() override { return device_->open(); }
  void close() noexcept override {
    closed_at_zero = last == Vec3(0);
    trial_.over = true;
    device_->close();
  }
  DeviceSample read() noexcept override { return device_->read(); }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    last = wrench.force;
    if (last != Vec3(0)) {
      if (trial_.wrong) last_push = ++pushes_after;
      if (++pushes == 100) {
        trial_.now = true;
        // In this very thread: the handler has run when raise returns.
        if (trial_.signals()) trial_.wrong = true, std::raise(trial_.number());
      }
    }
    device_->write(wrench, gc);
  }

  Vec3 last{9};
  int pushes = 0, pushes_after = 0, last_push = 0;
  bool closed_at_zero = false;

 private:
  Trial& trial_;
  std::unique_ptr<HapticDevice> device_;
};

TEST_P(ZeroInTime, OnTheSimulatedDeviceInItsOwnTicks) {
  const LoadedScene scene = pressed();
  Trial trial(GetParam());
  CountingDevice device(scene, trial);
  HalfSpace backend = failing(trial);
  // A stall ends nothing: the loop goes on without force, for a second.
  const auto summary = run_session(
      scene, backend, device,
      {.duration_s = trial.loss == Loss::kStall ? 1.5 : 60.0, .stop = &interrupt_flag()}, nullptr);
  ASSERT_TRUE(summary) << summary.error().sentence;
  std::printf("%s: %d ticks with force afterwards\n", name_of(GetParam()), device.pushes_after);
  ASSERT_TRUE(trial.wrong);
  EXPECT_GE(device.pushes, 100);
  // The loop looks at signals and failures before every tick. A failure is written down by the worker after
  // it happened, which may be any number of ticks later; the watchdog is the last to act.
  EXPECT_LE(device.pushes_after, trial.signals() ? 0 : kWatchdogTicks + kFadeTicks);
  EXPECT_TRUE(device.closed_at_zero);
  EXPECT_EQ(summary->stopped, trial.signals());
  EXPECT_EQ(summary->failure.has_value(), trial.loss == Loss::kDevice || trial.loss == Loss::kException);
}

TEST_P(ZeroInTime, OnAFalconInPacketsOnTheBus) {
  LoadedScene scene = pressed();
  scene.scene.start.position.z = -0.002;  // 2 N: within what the model's motors give
  Trial trial(GetParam());
  fake::FalconTable table({}, true);  // its firmware runs
  int pushes = 0, pushes_after = 0;
  std::atomic<bool> counting{true};
  std::chrono::steady_clock::time_point began{}, ended{};
  table.model.encoders = [&](int) {  // at every command, with the bus shut
    if (table.model.motors() != falcon::MotorCounts{}) {
      if (trial.wrong && counting) {
        if (pushes_after++ == 0 && began == std::chrono::steady_clock::time_point{})
          began = std::chrono::steady_clock::now();
        ended = std::chrono::steady_clock::now();
      }
      if (++pushes == 200) {
        began = std::chrono::steady_clock::now();
        trial.now = true;
        if (trial.signals()) trial.wrong = true, ::kill(::getpid(), trial.number());
      }
    }
    return falcon::Encoders{};
  };
  auto made = falcon::make_falcon({}, scene.scene.start, table.opener());
  ASSERT_TRUE(made) << made.error().sentence;
  HalfSpace backend = failing(trial);
  std::thread watch([&] {  // a stalled worker goes on once the motors have been still for half a second: then
                           // force may come back
    for (int still = 0; trial.loss == Loss::kStall && still < 100;) {
      std::this_thread::sleep_for(5ms);
      still = trial.wrong && table.locked([&] { return table.model.motors() == falcon::MotorCounts{}; })
                  ? still + 1
                  : 0;
    }
    counting = false;
    trial.over = true;
  });
  const auto summary = run_session(
      scene, backend, **made,
      {.duration_s = trial.loss == Loss::kStall ? 3.0 : 60.0, .stop = &interrupt_flag()}, nullptr);
  watch.join();
  ASSERT_TRUE(summary) << summary.error().sentence;
  const double ms = pushes_after > 0 ? std::chrono::duration<double, std::milli>(ended - began).count() : 0;
  std::printf("%s: %d packets with force afterwards, the last after %.1f ms\n", name_of(GetParam()),
              pushes_after, ms);
  ASSERT_TRUE(trial.wrong);
  EXPECT_GE(pushes, 200) << "no force to take away";
  EXPECT_EQ(table.locked([&] { return table.model.motors(); }), (falcon::MotorCounts{}));
  // Watchdog and fade, a packet or two a millisecond; and a second more, for a machine that lets this process
  // wait that long while the bus goes on.
  EXPECT_LE(pushes_after, 2 * (kWatchdogTicks + kFadeTicks) + 1000);
}

}  // namespace
}  // namespace palpate
