#include "driver/safe_device.h"

#include <algorithm>

#include "driver/limits.h"

namespace palpate {

SafeDevice::SafeDevice(HapticDevice& device, const SafetySettings& settings)
    : device_(device), settings_(settings), can_(device.capabilities()) {}

SafeDevice::~SafeDevice() { close(); }

Result<void> SafeDevice::open() {
  if (auto opened = device_.open(); !opened) return opened;
  can_ = device_.capabilities();  // some devices know their axes only once open
  opened_ = true;
  faulted_ = false;
  fault_ = "";
  gain_ = 0;
  sent_ = slewed_ = {};
  passivity_.reset();
  ticks_since_fresh_ = 0;
  state_ = DeviceState::kOpening;
  return {};
}

void SafeDevice::close() noexcept {
  if (!opened_) return;
  opened_ = false;
  gain_ = 0;
  sent_ = {};
  state_ = DeviceState::kClosed;
  device_.write({}, last_pose_.position);
  device_.close();
}

DeviceSample SafeDevice::read() noexcept {
  DeviceSample sample = device_.read();
  if (opened_ && sample.state == DeviceState::kFault)
    latch(*device_.guidance() ? device_.guidance() : "the haptic device reported a fault");
  if (opened_ && sample.state == DeviceState::kReady && !sound(sample.pose))
    latch("the haptic device reported a pose that isn't finite or has no unit rotation");
  if (sound(sample.pose)) last_pose_ = sample.pose;
  sample.pose = last_pose_;
  if (faulted_) sample.state = DeviceState::kFault;
  state_ = sample.state;
  clutched_ = sample.clutched;
  return sample;
}

void SafeDevice::write(const Wrench& wrench, const Vec3& gc) noexcept {
  if (opened_ && !(finite(wrench) && finite(gc))) latch("a force or torque wasn't finite");
  step_gain();
  const Wrench before = sent_;
  sent_ = {};
  if (flowing()) {
    Wrench wanted = wrench;
    if (settings_.passivity) {
      passivity_.observe(before, gc, last_pose_.rotation);
      const Wrench damping = passivity_.damping();
      if (damping.force != Vec3(0) || damping.torque != Vec3(0)) ++damped_ticks_;
      wanted.force += damping.force;
      wanted.torque += damping.torque;
    }
    const Wrench able = device_.exertable(wanted, gc);
    if (!finite(able)) {
      latch("the haptic device found a wrench that isn't finite");
    } else {
      const Wrench inside{shortened(able.force, can_.max_force_n),
                          shortened(able.torque, can_.max_torque_nm)};
      if (inside.force != able.force || inside.torque != able.torque) ++saturated_ticks_;
      slew(inside);
      sent_ = {gain_ * slewed_.force, gain_ * slewed_.torque};
    }
  }
  if (!flowing()) slewed_ = {};
  // Zero is written too: a device that hears nothing may hold its last force.
  if (opened_) device_.write(sent_, finite(gc) ? gc : last_pose_.position);
}

/// Goes from the last wrench towards `wanted`, as far as the slew limit lets it. The gain comes after it, so
/// the limit delays neither a watchdog's fade nor a zero.
void SafeDevice::slew(const Wrench& wanted) noexcept {
  const Wrench change{wanted.force - slewed_.force, wanted.torque - slewed_.torque};
  const double ticks = settings_.slew_ticks;
  if (ticks > 0 && (length(change.force) > can_.max_force_n / ticks ||
                    length(change.torque) > can_.max_torque_nm / ticks)) {
    ++slewed_ticks_;
    slewed_.force += shortened(change.force, can_.max_force_n / ticks);
    slewed_.torque += shortened(change.torque, can_.max_torque_nm / ticks);
  } else {
    slewed_ = wanted;
  }
}

void SafeDevice::latch(const char* why) noexcept {
  if (!faulted_) fault_ = why;
  faulted_ = true;
  gain_ = 0;
}

void SafeDevice::step_gain() noexcept {
  if (!flowing()) {
    gain_ = 0;
    ticks_since_fresh_ =
        0;  // the watchdog watches results, and nobody asks for any before the device is ready
    return;
  }
  const bool late = settings_.watchdog_ticks > 0 && ticks_since_fresh_ >= settings_.watchdog_ticks;
  if (late) ++watchdog_ticks_;
  ++ticks_since_fresh_;
  const double step =
      late ? -1.0 / std::max(settings_.fade_out_ticks, 1) : 1.0 / std::max(settings_.fade_in_ticks, 1);
  gain_ = std::clamp(gain_ + step, 0.0, 1.0);
}

}  // namespace palpate
