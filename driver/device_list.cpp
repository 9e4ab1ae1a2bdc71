#include "driver/device_list.h"

#include "driver/simulated_device.h"

namespace palpate {

std::vector<HapticDeviceInfo> list_haptic_devices() {
  const std::string later = "not available in this version of palpate";
  return {
      {"simulated", "a hand that follows the scene's path, in real or virtual time", true, ""},
      {"falcon", "Novint Falcon, 3 forces", false, later},
      {"spacemouse", "3Dconnexion SpaceMouse, 6 axes in, no force", false, later},
      {"replay", "a recorded trace.csv", false, later},
  };
}

Result<std::unique_ptr<HapticDevice>> make_haptic_device(const std::string& name, const DeviceSettings& settings,
                                                         const Pose& start, const Vec3& tool_gc_m) {
  std::string known;
  for (const HapticDeviceInfo& info : list_haptic_devices()) {
    known += (known.empty() ? "" : ", ") + info.name;
    if (info.name != name) continue;
    if (!info.usable) return Error{ErrorCode::kNoDevice, "haptic device '" + name + "' is " + info.reason};
    return make_simulated_device(settings, start, tool_gc_m);
  }
  return Error{ErrorCode::kUsage, "unknown haptic device '" + name + "', known are " + known};
}

}  // namespace palpate
