#pragma once
#include <cstdint>

#include "driver/haptic_device.h"
#include "driver/passivity.h"

namespace palpate {

/// When force may flow and how fast it comes and goes. In ticks of 1 ms.
struct SafetySettings {
  int fade_in_ticks = 200;  ///< 0 → 1 after open, homing, a fault's end, or restart_fade(); 0: at once
  int watchdog_ticks = 20;  ///< ticks without fresh() after which force fades out; 0: no watchdog
  int fade_out_ticks =
      20;  ///< 1 → 0 once the watchdog has run out (chosen: as long as the watchdog's default)
  double slew_ticks =
      0;  ///< from no force to the device's largest in no fewer ticks, torque likewise; 0: no such limit
  bool passivity = false;  ///< damping takes back what the wall has made by itself (driver/passivity.h)
};

/// The last thing before the motors, round any device: whoever writes, only what is safe gets through.
/// In this order: passivity control, if it is on; only the device's exertable part; force and torque each
/// shortened to the device's limits, keeping their directions; no further from those of the tick before than
/// the slew limit allows; scaled by a gain in [0, 1] that rises from 0 and falls to 0 when the watchdog runs
/// out; and zero, at once, whenever the device isn't ready or is clutched, a pose or wrench isn't finite,
/// after any fault until the next open(), on close and destruction. One thread calls read, write and fresh;
/// they don't allocate, lock or throw. Refers to the device; closes it.
class SafeDevice final : public HapticDevice {
 public:
  /// `device` outlives it.
  SafeDevice(HapticDevice& device, const SafetySettings& settings);
  ~SafeDevice() override;
  SafeDevice(const SafeDevice&) = delete;
  SafeDevice& operator=(const SafeDevice&) = delete;

  /// The device's own, as are its capabilities.
  std::string name() const override { return device_.name(); }
  /// The device's own.
  DeviceCapabilities capabilities() const override { return device_.capabilities(); }
  Result<void> open() override;  ///< forgets an earlier fault, fades in anew
  void close() noexcept override;
  DeviceSample read() noexcept
      override;  ///< a pose that isn't one comes back as kFault, with the last sound pose
  const char* guidance() const noexcept override { return device_.guidance(); }
  double motion_s() const override { return device_.motion_s(); }
  Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept override {
    return device_.exertable(wrench, gc);
  }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override;

  /// Feeds the watchdog: a new result has arrived since the last write.
  void fresh() noexcept { ticks_since_fresh_ = 0; }
  /// Force starts again from zero (clutch, another plan or profile).
  void restart_fade() noexcept { gain_ = 0; }

  bool faulted() const noexcept { return faulted_; }  ///< latched until open()
  /// Why, one sentence, the device's own where it has one; "" without a fault.
  const char* fault() const noexcept { return fault_; }
  /// Share of the wrench that is let through, 0 to 1: it fades in after open().
  double gain() const noexcept { return gain_; }
  const Wrench& sent() const noexcept { return sent_; }  ///< by the last write, torque about its gc
  /// Writes with the watchdog run out.
  std::uint64_t watchdog_ticks() const noexcept { return watchdog_ticks_; }
  /// Writes that a limit shortened.
  std::uint64_t saturated_ticks() const noexcept { return saturated_ticks_; }
  /// Writes that the slew limit held back.
  std::uint64_t slewed_ticks() const noexcept { return slewed_ticks_; }
  std::uint64_t damped_ticks() const noexcept { return damped_ticks_; }  ///< writes with passivity damping

 private:
  /// Whether force may flow at all.
  bool flowing() const noexcept {
    return opened_ && !faulted_ && !clutched_ && state_ == DeviceState::kReady;
  }
  void latch(const char* why) noexcept;
  void step_gain() noexcept;
  void slew(const Wrench& wanted) noexcept;

  HapticDevice& device_;
  SafetySettings settings_;
  DeviceCapabilities can_;
  DeviceState state_ = DeviceState::kClosed;
  Pose last_pose_;
  Wrench sent_, slewed_;  ///< slewed_: before the gain
  double gain_ = 0;
  std::int64_t ticks_since_fresh_ = 0;
  Passivity passivity_;
  std::uint64_t watchdog_ticks_ = 0, saturated_ticks_ = 0, slewed_ticks_ = 0, damped_ticks_ = 0;
  const char* fault_ = "";
  bool faulted_ = false, opened_ = false, clutched_ = false;
};

}  // namespace palpate
