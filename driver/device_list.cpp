#include "driver/device_list.h"

#include <array>
#include <span>

#include "driver/falcon/falcon_device.h"
#include "driver/replay/replay_device.h"
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
  return {
      {"simulated", "a hand that follows the scene's path, in real or virtual time", true, ""},
      usb_info("falcon", "Novint Falcon, 3 forces; needs --firmware FILE unless it was loaded before", falcon),
      usb_info("spacemouse", "3Dconnexion SpaceMouse, 6 axes in, no force", spacemouse::kModels),
      {"replay", "a recorded trace.csv of any device: --device replay:FILE", true, ""},
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
      falcon.workspace = settings.workspace;
      return falcon::make_falcon(falcon, start);
    }
    if (name == "spacemouse") return spacemouse::make_spacemouse({.rate = {}, .workspace = settings.workspace}, start);
    if (name == "replay") {
      if (settings.replay_file.empty())
        return bad_value("haptic device 'replay' needs a recorded trace: --device replay:FILE, or the scene's device.path beside \"driver\": \"replay\"");
      return replay::make_replay(settings.replay_file, settings.max_force_n, settings.max_torque_nm);
    }
    return make_simulated_device(settings, start, tool_gc_m);
  }
  return Error{ErrorCode::kUsage, "unknown haptic device '" + name + "', known are " + known};
}

}  // namespace palpate
