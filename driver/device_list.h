#pragma once
#include <memory>
#include <string>
#include <vector>

#include "driver/haptic_device.h"
#include "model/result.h"
#include "model/scene/scene.h"

namespace palpate {

/// A kind of haptic device, for `palpate devices`.
struct HapticDeviceInfo {
  std::string name;  ///< as `--device` and the scene's `device.driver` spell it
  std::string what;  ///< a few words
  bool usable = false;
  std::string reason;  ///< why it can't be used, one sentence; empty when usable
};

/// All haptic devices that palpate drives, usable or with the reason why not.
std::vector<HapticDeviceInfo> list_haptic_devices();

/// Makes a device by name, closed. `settings` and `start` serve the simulated one; `tool_gc_m` is the tool's
/// centre of mass in the tool frame; `firmware` is the user's file for a device that loads one. Errors:
/// kUsage for a name nobody knows (lists the known), kBadValue for settings, a firmware file or a recorded
/// trace.
Result<std::unique_ptr<HapticDevice>> make_haptic_device(const std::string& name,
                                                         const DeviceSettings& settings, const Pose& start,
                                                         const Vec3& tool_gc_m,
                                                         const std::string& firmware = {});

}  // namespace palpate
