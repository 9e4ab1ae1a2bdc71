#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate {

/// Period of the control loop and of every device's tick, s.
inline constexpr double kTickSeconds = 1e-3;

/// What a device says of itself at a tick.
enum class DeviceState : std::uint8_t { kClosed, kOpening, kLoading, kHoming, kReady, kFault };

/// What a device can sense and exert; axes in the order x y z rx ry rz.
struct DeviceCapabilities {
  std::array<bool, 6> sensed{};
  std::array<bool, 6> actuated{};
  double max_force_n = 0;            ///< largest length of the force; 0: none is ever sent
  double max_torque_nm = 0;          ///< largest length of the torque; 0: none is ever sent
  double max_stiffness_n_per_m = 0;  ///< 0: not stated
  double rate_hz = 1000;
};

/// What the device reports at a tick.
struct DeviceSample {
  Pose pose;                 ///< world from tool
  std::int64_t time_ns = 0;  ///< when it was sensed: steady clock, or virtual time
  std::uint32_t buttons = 0;
  DeviceState state = DeviceState::kClosed;
  int stage = 0;          ///< of the recorded or simulated path, 0: none
  bool clutched = false;  ///< the hand moves without the tool, or was paused: it must feel nothing
  bool paused = false;    ///< somebody has taken the force off from outside; a simulated device stands still,
                          ///< this pose included
};

/// A haptic device. Implement it to plug in a device with a closed SDK (docs/examples).
/// open and close may take their time; read and write are called once a tick by one thread and never
/// allocate, lock, throw or wait longer than the tick allows. A device that fails reports kFault in its
/// sample and ignores wrenches.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  /// As `palpate devices` and summaries have it.
  virtual std::string name() const = 0;
  /// Axes and limits; the same before and after open().
  virtual DeviceCapabilities capabilities() const = 0;
  /// Finds it and makes it ready, force zero. Error: why it can't be used, in one sentence.
  virtual Result<void> open() = 0;
  virtual void close() noexcept = 0;  ///< forces zero, then closed
  /// Where it is; once a tick. Never allocates, locks or waits.
  virtual DeviceSample read() noexcept = 0;
  /// What the person at the device should do now (home it, plug it in), or why it is at fault; "" when there
  /// is nothing to say. Text that outlives the device; the thread that reads may ask.
  virtual const char* guidance() const noexcept { return ""; }
  /// How long the device moves by itself, s; 0: a person moves it, for as long as they like.
  virtual double motion_s() const { return 0; }
  /// The part of a wrench that the motors can exert at the pose last read; what they can't is left out before
  /// limits apply, so that it doesn't use them up. As given: the actuated axes of the world. A device whose
  /// axes are its own (a guide, a tilted base) overrides it. Called like write().
  virtual Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept;
  /// Force and torque on the hand's tool, world frame, torque about the centre of mass gc given in world
  /// metres.
  virtual void write(const Wrench& wrench, const Vec3& gc) noexcept = 0;
};

inline Wrench HapticDevice::exertable(const Wrench& wrench, const Vec3& /*gc*/) const noexcept {
  const DeviceCapabilities can = capabilities();
  Wrench left;
  for (int axis = 0; axis < 3; ++axis) {
    if (can.actuated[static_cast<std::size_t>(axis)]) left.force[axis] = wrench.force[axis];
    if (can.actuated[static_cast<std::size_t>(axis) + 3]) left.torque[axis] = wrench.torque[axis];
  }
  return left;
}

}  // namespace palpate
