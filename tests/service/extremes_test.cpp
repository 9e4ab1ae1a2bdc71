// Whatever device, back end and clock do: force stays finite and within the device's limits, and is zero when
// nothing can be trusted. PALPATE_EXTREME_TICKS sets how long it tries (default 200,000); prints what a tick
// costs, and asserts no time.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>

#include "driver/limits.h"
#include "model/lattice/rotation.h"
#include "service/loop/axis_loop.h"
#include "service/loop/control_loop.h"
#include "tests/driver/allocation_count.h"

namespace palpate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                 kInf = std::numeric_limits<double>::infinity();

std::int64_t ticks_to_try() {
  const char* text = std::getenv("PALPATE_EXTREME_TICKS");
  return text != nullptr ? std::atoll(text) : 200'000;
}

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  bool one_in(double n) { return unit() * n < 1; }
  double log(double low, double high) { return low * std::pow(high / low, unit()); }
  Vec3 vector(double reach) { return reach * Vec3(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1); }
  double broken() { return one_in(3) ? kNan : one_in(2) ? kInf : -kInf; }

 private:
  std::mt19937 random_;
};

/// A device that homes, jumps, turns through π, reports rubbish and now and then a fault; it remembers the
/// worst that reached it.
class WildDevice final : public HapticDevice {
 public:
  explicit WildDevice(Dice& dice) : dice_(dice) {}
  std::string name() const override { return "wild"; }
  DeviceCapabilities capabilities() const override {
    return {.actuated = {true, true, true, true, true, true}, .max_force_n = 20, .max_torque_nm = 2};
  }
  Result<void> open() override {
    pose_ = {};
    return {};
  }
  void close() noexcept override {}
  /// Draws the next sample. Apart from read(), so that the dice don't count as a part of the tick.
  void live() {
    pose_.position += dice_.vector(speed);
    pose_.rotation = glm::normalize(rotation_by(dice_.vector(10 * speed)) * pose_.rotation);
    if (dice_.one_in(5000)) pose_.position = dice_.vector(1.0);  // homing
    if (dice_.one_in(5000)) pose_.rotation = rotation_by(dice_.vector(3.2));
    if (dice_.one_in(3)) pose_.rotation = -pose_.rotation;  // the same one
    DeviceSample sample{.pose = pose_, .state = DeviceState::kReady};
    if (dice_.one_in(400)) sample.state = dice_.one_in(2) ? DeviceState::kHoming : DeviceState::kLoading;
    if (dice_.one_in(20000)) sample.state = DeviceState::kFault;
    if (dice_.one_in(20000)) sample.pose.position.y = dice_.broken();
    if (dice_.one_in(20000)) sample.pose.rotation.x = dice_.broken();
    told_ = sample.state;
    sound_ = sound(sample.pose);
    sample_ = sample;
  }
  DeviceSample read() noexcept override { return sample_; }
  void write(const Wrench& wrench, const Vec3&) noexcept override {
    all_finite = all_finite && finite(wrench);
    // A millionth: what rounding may make of a shortened vector, and more.
    within = within && length(wrench.force) <= 20 * (1 + 1e-6) && length(wrench.torque) <= 2 * (1 + 1e-6);
    if (told_ != DeviceState::kReady || !sound_)
      zero_when_untrusted = zero_when_untrusted && wrench.force == Vec3(0) && wrench.torque == Vec3(0);
    pushed = pushed || length(wrench.force) > 1;
  }

  double speed = 1e-4;  // m a tick
  Pose pose_;
  bool all_finite = true, within = true, zero_when_untrusted = true, pushed = false;

 private:
  Dice& dice_;
  DeviceSample sample_;
  DeviceState told_ = DeviceState::kReady;
  bool sound_ = true;
};

LawResult wild_result(Dice& dice, const Pose& pose, std::int64_t tick, double stiffness) {
  LawResult result;
  result.tick = tick - static_cast<std::int64_t>(50 * dice.unit() * dice.unit()) +
                (dice.one_in(200) ? 3 : 0);  // old, out of order, from the future
  result.gc = pose.position + dice.vector(1e-3);
  result.rotation = pose.rotation;
  result.contact = true;
  const double share = dice.unit();
  result.plane_count = static_cast<std::uint32_t>((dice.one_in(20) ? 32.9 : 5.9) * share);
  for (std::uint32_t i = 0; i < result.plane_count; ++i) {
    const double depth = dice.log(1e-7, 1e-1);
    result.planes[i] = {glm::normalize(dice.vector(1) + Vec3(0, 0, 1e-3)), dice.vector(0.3),
                        stiffness * depth, stiffness * (0.25 + 0.75 * dice.unit())};
    result.wrench.force += result.planes[i].force * result.planes[i].normal;
  }
  if (dice.one_in(100))
    result.planes[0].force = dice.broken(), result.plane_count = std::max(result.plane_count, 1u);
  if (dice.one_in(100)) result.gc.z = dice.broken();
  if (dice.one_in(100)) result.wrench.torque.x = dice.broken();
  if (dice.one_in(100)) result.rotation = {0, 0, 0, 0};
  return result;
}

TEST(Extremes, ForceStaysFiniteAndWithinTheLimitsAndIsZeroWhenNothingCanBeTrusted) {
  const std::int64_t ticks = ticks_to_try();
  constexpr std::int64_t kEpisode = 5000;
  Dice dice(23);
  Histogram cost_ns, coupled_ns, empty_ns;
  bool pushed = false;
  for (std::int64_t done = 0; done < ticks; done += kEpisode) {
    WildDevice device(dice);
    device.speed = dice.log(1e-7, 2e-2);
    SafeDevice safe(device, {.fade_in_ticks = static_cast<int>(50 * dice.unit()),
                             .watchdog_ticks = dice.one_in(4) ? 0 : 20,
                             .slew_ticks = dice.one_in(3) ? 0.0 : 5.0,
                             .passivity = dice.one_in(2)});
    ASSERT_TRUE(safe.open());
    const double stiffness = dice.log(1, 1e6);
    const ForceLawSettings law{.kind = dice.one_in(4) ? LawKind::kPrinted : LawKind::kCorrected,
                               .stiffness_n_per_m = stiffness,
                               .transitions = static_cast<int>(12 * dice.unit()),
                               .change_n_per_s = dice.one_in(4) ? 0.0 : 100.0};
    const CouplingSettings coupling{dice.one_in(4) ? dice.log(1, 1e6) : 0,
                                    dice.one_in(4) ? dice.log(1e-3, 1e5) : 0};
    const auto control =
        std::make_unique<ControlTick>(safe, law, Vec3(0.01, 0, 0), Couplings{coupling, coupling});
    const double rarely = dice.log(1, 60);
    const bool empty = dice.one_in(10);
    const std::size_t before = allocations_of_this_thread();
    std::int64_t tick = 0;
    for (std::int64_t i = 0; i < kEpisode; ++i) {
      tick += dice.one_in(300) ? 1 + static_cast<std::int64_t>(20 * dice.unit()) : 1;  // up to 20 ms late
      device.live();
      LawResult result;
      const bool comes = !empty && dice.one_in(rarely);
      if (comes) result = wild_result(dice, device.pose_, tick, stiffness);
      const auto start = std::chrono::steady_clock::now();
      control->sense(tick);
      control->act(comes ? &result : nullptr);
      (empty           ? empty_ns
       : coupling.on() ? coupled_ns
                       : cost_ns)
          .add(std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start)
                   .count());
    }
    ASSERT_EQ(allocations_of_this_thread(), before);
    ASSERT_TRUE(device.all_finite && device.within && device.zero_when_untrusted)
        << "K " << stiffness << " N/m, " << device.speed << " m a tick, law " << static_cast<int>(law.kind);
    pushed = pushed || device.pushed;
  }
  EXPECT_TRUE(pushed) << "all that for nothing";
  const auto us = [](const Histogram& histogram, double share) { return histogram.percentile(share) / 1e3; };
  std::printf(
      "%lld ticks; a tick: p50 %.2f, p99 %.2f, p99.9 %.2f us; with a virtual coupling p50 %.2f, p99 %.2f us; "
      "without results p50 %.2f, p99 %.2f us\n",
      static_cast<long long>(ticks), us(cost_ns, 0.5), us(cost_ns, 0.99), us(cost_ns, 0.999),
      us(coupled_ns, 0.5), us(coupled_ns, 0.99), us(empty_ns, 0.5), us(empty_ns, 0.99));
}

TEST(Extremes, TheCorrectedLawNeitherPullsNorLosesItsNumbersInAClosedLoop) {
  // The list of what a device may be: 0.02–5 kg, 0–10 N·s/m, 1–10^6 N/m, results 0–50 ms old, late, in bursts
  // or lost, motors late.
  Dice dice(29);
  const int runs = static_cast<int>(std::min<std::int64_t>(ticks_to_try() / 1000, 5000));
  for (int run = 0; run < runs; ++run) {
    AxisLoop loop;
    const double k = dice.log(1, 1e6);
    loop.mass_kg = dice.log(0.02, 5);
    loop.damping = 10 * dice.unit();
    loop.hand_stiffness = dice.one_in(2) ? 0 : dice.log(1, 1e5);
    loop.hand_damping = 10 * dice.unit();
    loop.delivery = {.kind = static_cast<Delivery::Kind>(static_cast<int>(3.99 * dice.unit())),
                     .delay = static_cast<int>(50.99 * dice.unit()),
                     .seed = static_cast<std::uint64_t>(run)};
    loop.device_delay = static_cast<int>(5 * dice.unit());
    loop.encoder_step_m = dice.one_in(2) ? 0 : dice.log(1e-7, 1e-4);
    loop.law = {.stiffness_n_per_m = k,
                .transitions = static_cast<int>(20 * dice.unit()),
                .change_n_per_s = dice.one_in(3) ? 0.0 : 100.0};
    loop.contact = linear_wall(k, 0, 1 + static_cast<std::uint32_t>(4 * dice.unit()));
    loop.load_n = -10 * dice.unit();
    loop.start_x = 1e-3;
    loop.start_speed = -dice.unit();
    loop.settle_ticks = 0;
    loop.reach_m = 100;
    const AxisLoop::Outcome outcome = loop.run(2000);
    ASSERT_TRUE(outcome.finite) << run;
    ASSERT_GE(outcome.least_force_n, 0) << run;
  }
}

}  // namespace
}  // namespace palpate
