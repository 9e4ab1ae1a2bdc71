#include "driver/simulated_device.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "driver/limits.h"
#include "driver/mass_spring.h"
#include "driver/path.h"
#include "model/lattice/rotation.h"

namespace palpate {
namespace {

/// Hand, device and path; what the two kinds of motion share.
class SimulatedDevice : public HapticDevice {
 public:
  SimulatedDevice(const DeviceSettings& settings, const Pose& start, const Vec3& tool_gc)
      : settings_(settings),
        tool_gc_(tool_gc),
        sliding_(settings.mass_kg + settings.hand_mass_kg,
                 settings.damping_n_s_per_m + settings.hand_damping_n_s_per_m,
                 settings.hand_stiffness_n_per_m, kTickSeconds),
        turning_(settings.inertia_kg_m2, settings.angular_damping_nm_s + settings.hand_angular_damping_nm_s,
                 settings.hand_angular_stiffness_nm, kTickSeconds) {
    moves_ = !settings_.path.empty();
    if (!moves_) settings_.path.push_back({.pose = start});
  }

  std::string name() const final { return "simulated"; }

  DeviceCapabilities capabilities() const final {
    return {.sensed = {true, true, true, true, true, true},
            .actuated = settings_.actuated,
            .max_force_n = settings_.max_force_n,
            .max_torque_nm = settings_.max_torque_nm};
  }

  double motion_s() const final { return moves_ ? settings_.path.back().time_s : 0; }

  Result<void> open() final {
    ticks_ = 0;
    hand_ = path_at(settings_.path, 0);
    rest();
    open_ = true;
    return {};
  }

  void close() noexcept final { open_ = false; }

  DeviceSample read() noexcept final {
    return {.pose = pose_,
            .time_ns = ticks_ * std::int64_t{1'000'000},
            .state = open_ ? DeviceState::kReady : DeviceState::kClosed,
            .stage = hand_.stage};
  }

  void write(const Wrench& wrench, const Vec3& gc) noexcept final {
    if (!open_) return;
    ++ticks_;
    const PathPoint next = path_at(settings_.path, static_cast<double>(ticks_) * kTickSeconds);
    // A wrench that isn't one is no wrench.
    advance(finite(wrench) && finite(gc) ? wrench : Wrench{}, gc, next);
    hand_ = next;
  }

 protected:
  /// At the hand's first point, without motion.
  virtual void rest() noexcept = 0;
  /// One tick under `wrench` (torque about `gc`), the hand going from hand_ to `next`.
  virtual void advance(const Wrench& wrench, const Vec3& gc, const PathPoint& next) noexcept = 0;

  /// The tool turning about a pivot in some frame, pulled by the hand from rotation `from` to `to`.
  void turn(Quat& rotation, Vec3& rate, const Quat& from, const Quat& to, const Vec3& torque) const noexcept {
    const Vec3 hand_rate = rotation_vector(to * glm::conjugate(from)) / kTickSeconds;
    Vec3 stretch = rotation_vector(rotation * glm::conjugate(from));
    Vec3 stretch_rate = rate - hand_rate;
    turning_.step(stretch, stretch_rate, torque - settings_.angular_damping_nm_s * hand_rate);
    rotation = glm::normalize(rotation_by(stretch) * to);
    rate = stretch_rate + hand_rate;
  }

  /// Position and velocity pulled by the hand from `from` to `to`; V is a vector, or a travel.
  template <class V>
  void slide(V& position, V& velocity, const V& from, const V& to, const V& force) const noexcept {
    const V hand_velocity = (to - from) / kTickSeconds;
    V stretch = position - from, stretch_velocity = velocity - hand_velocity;
    sliding_.step(stretch, stretch_velocity, force - settings_.damping_n_s_per_m * hand_velocity);
    position = to + stretch;
    velocity = stretch_velocity + hand_velocity;
  }

  Wrench masked(Wrench wrench) const noexcept {
    for (int axis = 0; axis < 3; ++axis) {
      if (!settings_.actuated[static_cast<std::size_t>(axis)]) wrench.force[axis] = 0;
      if (!settings_.actuated[static_cast<std::size_t>(axis) + 3]) wrench.torque[axis] = 0;
    }
    return wrench;
  }

  DeviceSettings settings_;
  Vec3 tool_gc_;  ///< tool frame, m
  MassSpring sliding_, turning_;
  PathPoint hand_;  ///< where the hand is at the present tick
  Pose pose_;       ///< of the tool, world

 private:
  std::int64_t ticks_ = 0;
  bool open_ = false, moves_ = false;
};

/// Six degrees of freedom; the state is gc and the tool's rotation.
class FreeDevice final : public SimulatedDevice {
 public:
  using SimulatedDevice::SimulatedDevice;

 private:
  Vec3 gc_of(const Pose& pose) const noexcept { return pose.position + pose.rotation * tool_gc_; }

  void rest() noexcept override {
    pose_ = hand_.pose;
    gc_ = gc_of(pose_);
    velocity_ = rate_ = Vec3(0);
  }

  void advance(const Wrench& wrench, const Vec3& gc, const PathPoint& next) noexcept override {
    const Wrench exerted = masked(moved(wrench, gc, gc_));
    slide(gc_, velocity_, gc_of(hand_.pose), gc_of(next.pose),
          shortened(exerted.force, settings_.max_force_n));
    turn(pose_.rotation, rate_, hand_.pose.rotation, next.pose.rotation,
         shortened(exerted.torque, settings_.max_torque_nm));
    pose_.position = gc_ - pose_.rotation * tool_gc_;
  }

  Vec3 gc_{0}, velocity_{0}, rate_{0};  ///< m, m/s, rad/s, world
};

/// One travel and three rotations; the state is the travel and the rotation relative to the guide's frame.
class GuidedDevice final : public SimulatedDevice {
 public:
  using SimulatedDevice::SimulatedDevice;

  Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept override {
    return moved(pivot_wrench(moved(wrench, gc, pose_.position)), pose_.position, gc);
  }

 private:
  /// What the motors can do about the pivot: a force along the guide, torques about the frame's axes.
  Wrench pivot_wrench(const Wrench& wrench) const noexcept {
    const double slope = length(at_.tangent);
    Vec3 along(0);
    if (settings_.actuated[0] && slope > 0)
      along = (glm::dot(wrench.force, at_.tangent) / (slope * slope)) * at_.tangent;
    Vec3 torque = glm::conjugate(at_.frame.rotation) * wrench.torque;
    for (int axis = 0; axis < 3; ++axis)
      if (!settings_.actuated[static_cast<std::size_t>(axis) + 3]) torque[axis] = 0;
    return {along, at_.frame.rotation * torque};
  }

  void rest() noexcept override {
    travel_ = std::clamp(hand_.travel_m, settings_.guide.front().travel_m, settings_.guide.back().travel_m);
    relative_ = hand_.pose.rotation;
    speed_ = 0;
    rate_ = Vec3(0);
    place();
  }

  void advance(const Wrench& wrench, const Vec3& gc, const PathPoint& next) noexcept override {
    Wrench exerted = pivot_wrench(moved(wrench, gc, pose_.position));
    exerted = {shortened(exerted.force, settings_.max_force_n),
               shortened(exerted.torque, settings_.max_torque_nm)};
    // Virtual work of the wrench on a travel: the origin moves along the tangent, and the whole tool turns
    // with the frame.
    const double push = glm::dot(exerted.force, at_.tangent) + glm::dot(exerted.torque, at_.turning);
    slide(travel_, speed_, hand_.travel_m, next.travel_m, push);
    turn(relative_, rate_, hand_.pose.rotation, next.pose.rotation,
         glm::conjugate(at_.frame.rotation) * exerted.torque);
    // The guide's ends are hard.
    const double first = settings_.guide.front().travel_m, last = settings_.guide.back().travel_m;
    if (travel_ <= first) travel_ = first, speed_ = std::fmax(speed_, 0);
    if (travel_ >= last) travel_ = last, speed_ = std::fmin(speed_, 0);
    place();
  }

  void place() noexcept {
    at_ = guide_at(settings_.guide, travel_);
    pose_.position = at_.frame.position;
    pose_.rotation = glm::normalize(at_.frame.rotation * relative_);
  }

  double travel_ = 0, speed_ = 0;  ///< m, m/s
  Quat relative_{1, 0, 0, 0};      ///< guide frame from tool
  Vec3 rate_{0};                   ///< rad/s, guide frame
  GuideState at_;
};

/// Names the first setting that makes no sense; empty: all fine.
std::string fault_in(const DeviceSettings& settings, const Pose& start, const Vec3& tool_gc) {
  const auto at_least = [](double value, double least, const char* name) {
    return std::isfinite(value) && value >= least
               ? std::string()
               : std::string("simulated device: ") + name + " is " + std::to_string(value) +
                     ", must be a finite number ≥ " + std::to_string(least);
  };
  constexpr double kLeastMass = 1e-3, kLeastInertia = 1e-7;  // chosen: nothing that a hand holds is lighter
  for (const std::string& fault :
       {at_least(settings.mass_kg, kLeastMass, "mass (kg)"),
        at_least(settings.inertia_kg_m2, kLeastInertia, "inertia (kg·m²)"),
        at_least(settings.damping_n_s_per_m, 0, "damping (N·s/m)"),
        at_least(settings.angular_damping_nm_s, 0, "angular damping (N·m·s)"),
        at_least(settings.hand_stiffness_n_per_m, 0, "hand stiffness (N/m)"),
        at_least(settings.hand_damping_n_s_per_m, 0, "hand damping (N·s/m)"),
        at_least(settings.hand_mass_kg, 0, "hand mass (kg)"),
        at_least(settings.hand_angular_stiffness_nm, 0, "hand angular stiffness (N·m)"),
        at_least(settings.hand_angular_damping_nm_s, 0, "hand angular damping (N·m·s)"),
        at_least(settings.max_force_n, 0, "largest force (N)"),
        at_least(settings.max_torque_nm, 0, "largest torque (N·m)")})
    if (!fault.empty()) return fault;
  if (!sound(start) || !finite(tool_gc)) return "simulated device: start pose or centre of mass isn't finite";
  for (std::size_t i = 0; i < settings.path.size(); ++i) {
    const PathPoint& point = settings.path[i];
    const std::string place = "simulated device: path point " + std::to_string(i);
    if (!std::isfinite(point.time_s) || !std::isfinite(point.travel_m) || !sound(point.pose))
      return place + " isn't finite or has no unit rotation";
    if (i > 0 && point.time_s < settings.path[i - 1].time_s)
      return place + " is at " + std::to_string(point.time_s) + " s, before the point ahead of it";
  }
  if (settings.guide.size() == 1) return "simulated device: a guide needs at least 2 points, this one has 1";
  for (std::size_t i = 0; i < settings.guide.size(); ++i) {
    const GuidePoint& point = settings.guide[i];
    const std::string place = "simulated device: guide point " + std::to_string(i);
    if (!std::isfinite(point.travel_m) || !sound(point.frame))
      return place + " isn't finite or has no unit rotation";
    if (i > 0 && !(point.travel_m > settings.guide[i - 1].travel_m))
      return place + " has travel " + std::to_string(point.travel_m) + " m, not beyond the point ahead of it";
  }
  return {};
}

}  // namespace

Result<std::unique_ptr<HapticDevice>> make_simulated_device(const DeviceSettings& settings, const Pose& start,
                                                            const Vec3& tool_gc_m) {
  if (std::string fault = fault_in(settings, start, tool_gc_m); !fault.empty())
    return bad_value(std::move(fault));
  if (settings.guide.empty())
    return std::unique_ptr<HapticDevice>(std::make_unique<FreeDevice>(settings, start, tool_gc_m));
  return std::unique_ptr<HapticDevice>(std::make_unique<GuidedDevice>(settings, start, tool_gc_m));
}

}  // namespace palpate
