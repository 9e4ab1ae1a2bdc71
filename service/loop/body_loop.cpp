#include "service/loop/body_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "driver/limits.h"
#include "model/lattice/rotation.h"
#include "service/loop/control_loop.h"

namespace palpate {
namespace {

constexpr double kArm = 0.05;  // m: what a turn is weighed by

/// The simulated device, on which a load acts besides its motors.
class LoadedDevice final : public HapticDevice {
 public:
  explicit LoadedDevice(HapticDevice& device) : device_(device) {}
  std::string name() const override { return device_.name(); }
  DeviceCapabilities capabilities() const override { return device_.capabilities(); }
  Result<void> open() override { return device_.open(); }
  void close() noexcept override { device_.close(); }
  DeviceSample read() noexcept override { return device_.read(); }
  Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept override {
    return device_.exertable(wrench, gc);
  }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    const Wrench& acts = own ? *own : wrench;
    sent = acts;
    device_.write({acts.force + load.force, acts.torque + load.torque}, gc);
  }

  Wrench load, sent;
  const Wrench* own = nullptr;  ///< in place of what is written

 private:
  HapticDevice& device_;
};

using Six = std::array<double, 6>;

struct Ranges {
  Six least, most;
  Ranges() {
    least.fill(std::numeric_limits<double>::infinity()), most.fill(-std::numeric_limits<double>::infinity());
  }
  void add(const Six& x) {
    for (std::size_t i = 0; i < 6; ++i)
      least[i] = std::min(least[i], x[i]), most[i] = std::max(most[i], x[i]);
  }
  double size() const {
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i)
      if (most[i] > least[i]) sum += (most[i] - least[i]) * (most[i] - least[i]);
    return std::sqrt(sum);
  }
};

}  // namespace

AxisLoop::Outcome BodyLoop::run(int ticks) const {
  AxisLoop::Outcome out;
  out.least_force_n = 0;
  DeviceSettings unlimited = device;
  unlimited.max_force_n = unlimited.max_torque_nm = 1e9;
  auto made = make_device(unlimited, at_rest);
  if (!made) {
    out.finite = false;
    return out;
  }
  LoadedDevice loaded(**made);
  SafeDevice safe(loaded, {.fade_in_ticks = 0, .watchdog_ticks = 0, .passivity = passivity});
  if (!safe.open()) {
    out.finite = false;
    return out;
  }
  const auto control = std::make_unique<ControlTick>(safe, law, Vec3(0), Couplings{coupling, coupling});
  Ranges second, last;
  Courier courier(delivery);
  double work = 0;
  const Wrench balance{-load.force, -load.torque};
  Vec3 felt(0);
  Pose before = at_rest;
  for (int i = 0; i < ticks; ++i) {
    const Pose tool = control->sense(i).pose;
    const LawResult* fresh = courier.at(i, tool, [&](LawResult& result) { contact(tool, result); });

    const Pose pose = loaded.read().pose;
    loaded.own = i < settle_ticks ? &balance : nullptr;
    loaded.load = load;
    if (i == settle_ticks) loaded.load.force += kick.force, loaded.load.torque += kick.torque;
    control->act(fresh);

    const Vec3 turn = rotation_vector(pose.rotation * glm::conjugate(before.rotation));
    work += glm::dot(
        felt, pose.position - before.position);  // of the force of the tick before; a turn's work is left out
    out.energy_out_j = std::max(out.energy_out_j, work);
    if (i > settle_ticks + 1)
      out.largest_step_n = std::max(out.largest_step_n, glm::length(loaded.sent.force - felt));
    out.largest_force_n = std::max(out.largest_force_n, glm::length(loaded.sent.force));
    felt = loaded.sent.force;
    before = pose;
    const Vec3 away = pose.position - at_rest.position,
               turned = kArm * rotation_vector(pose.rotation * glm::conjugate(at_rest.rotation));
    out.finite = out.finite && finite(away) && finite(turned) && finite(turn);
    if (!(glm::length(away) + glm::length(turned) < reach_m)) {
      out.ran_away = true;
      break;
    }
    const Six now_at{away.x, away.y, away.z, turned.x, turned.y, turned.z};
    if (i > ticks / 4 && i <= ticks / 2) second.add(now_at);
    if (i > ticks - ticks / 4) last.add(now_at);
  }
  out.early = second.size();
  out.late = last.size();
  return out;
}

std::function<void(const Pose&, LawResult&)> pads_contact(std::vector<Pad> pads, double stiffness,
                                                          double load_n, const Pose& at_rest,
                                                          bool pushes_only) {
  return [=, pads = std::move(pads)](const Pose& gc, LawResult& out) {
    for (const Pad& pad : pads) {
      const Vec3 lever = gc.rotation * pad.at, rest = at_rest.position + at_rest.rotation * pad.at;
      const double force =
          pad.share * (load_n - stiffness * glm::dot(pad.normal, gc.position + lever - rest));
      if (pushes_only && !(force > 0)) continue;
      const Vec3 twist = glm::cross(lever, pad.normal);
      out.contact = true;
      out.wrench.force += force * pad.normal;
      out.wrench.torque += force * twist;
      if (out.plane_count == kMaxLawPlanes) continue;
      out.planes[out.plane_count++] = {
          .normal = pad.normal, .lever = twist, .force = force, .stiffness = pad.share * stiffness};
      out.areas = out.plane_count;
    }
  };
}

Wrench pads_load(const std::vector<Pad>& pads, double load_n) {
  Wrench sum;
  for (const Pad& pad : pads) {
    sum.force += load_n * pad.share * pad.normal;
    sum.torque += load_n * pad.share * glm::cross(pad.at, pad.normal);
  }
  return sum;
}

double body_theory(const DeviceSettings& device, const std::vector<Pad>& pads, double lag_s) {
  const double slides = device.damping_n_s_per_m + device.hand_damping_n_s_per_m,
               turns = device.angular_damping_nm_s + device.hand_angular_damping_nm_s;
  // The largest eigenvalue of B^−½ J B^−½, by the power method from a vector that is orthogonal to nothing of
  // use.
  Six x{1, 0.9, 0.8, 0.7, 0.6, 0.5};
  double largest = 0;
  for (int round = 0; round < 2000; ++round) {
    Six next{};
    for (const Pad& pad : pads) {
      const Vec3 twist = glm::cross(pad.at, pad.normal);
      Six along{pad.normal.x, pad.normal.y, pad.normal.z, twist.x, twist.y, twist.z};
      double dot = 0;
      for (std::size_t i = 0; i < 6; ++i)
        along[i] = device.actuated[i] ? along[i] / std::sqrt(i < 3 ? slides : turns) : 0,
        dot += along[i] * x[i];
      for (std::size_t i = 0; i < 6; ++i) next[i] += pad.share * dot * along[i];
    }
    double size = 0;
    for (const double v : next) size += v * v;
    largest = std::sqrt(size);
    if (!(largest > 0)) return std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 6; ++i) x[i] = next[i] / largest;
  }
  return 1 / (largest * (0.5 * kTickSeconds + lag_s));
}

}  // namespace palpate
