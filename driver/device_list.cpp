#include "driver/device_list.h"

#include <array>
#include <span>

#include "driver/falcon/falcon_device.h"
#include "driver/simulated_device.h"
#include "driver/spacemouse/report.h"
#include "driver/spacemouse/spacemouse_device.h"
#include "driver/usb_port.h"

namespace palpate {

namespace {

/// Whether a USB device can be used now, and why not.
HapticDeviceInfo usb_info(std::string name, std::string what, std::span<const UsbId> ids) {
  HapticDeviceInfo info{std::move(name), std::move(what), false, "not plugged in"};
  for (const UsbDeviceInfo& device : list_usb_devices(ids)) {
    info.usable = info.usable || device.usable;
    info.reason = info.usable ? "" : device.reason;
  }
  return info;
}

}  // namespace

std::vector<HapticDeviceInfo> list_haptic_devices() {
  constexpr std::array falcon{falcon::kUsbId};
  const std::string later = "not available in this version of palpate";
  return {
      {"simulated", "a hand that follows the scene's path, in real or virtual time", true, ""},
      usb_info("falcon", "Novint Falcon, 3 forces; needs --firmware FILE unless it was loaded before", falcon),
      usb_info("spacemouse", "3Dconnexion SpaceMouse, 6 axes in, no force", spacemouse::kModels),
      {"replay", "a recorded trace.csv", false, later},
  };
}

Result<std::unique_ptr<HapticDevice>> make_haptic_device(const std::string& name, const DeviceSettings& settings,
                                                         const Pose& start, const Vec3& tool_gc_m, const std::string& firmware) {
  std::string known;
  for (const HapticDeviceInfo& info : list_haptic_devices()) {
    known += (known.empty() ? "" : ", ") + info.name;
    if (info.name != name) continue;
    if (name == "falcon") {
      falcon::FalconSettings falcon;
      falcon.firmware = firmware;
      return falcon::make_falcon(falcon, start);
    }
    if (name == "spacemouse") return spacemouse::make_spacemouse({}, start);
    if (!info.usable) return Error{ErrorCode::kNoDevice, "haptic device '" + name + "' is " + info.reason};
    return make_simulated_device(settings, start, tool_gc_m);
  }
  return Error{ErrorCode::kUsage, "unknown haptic device '" + name + "', known are " + known};
}

}  // namespace palpate
