#include "driver/device_list.h"

#include <array>
#include <charconv>
#include <optional>
#include <span>
#include <string_view>

#include "driver/falcon/falcon_device.h"
#include "driver/inverse3/inverse3_device.h"
#include "driver/inverse3/inverse3_link.h"
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
  const Result<std::vector<UsbDeviceInfo>> found = list_usb_devices(ids);
  if (!found) {
    info.reason = found.error().sentence;
    return info;
  }
  for (const UsbDeviceInfo& device : *found) {
    if (device.usable && device.kernel_driver)
      info.what += "; the kernel's own driver has it now, palpate takes it over for a run";
    info.usable = info.usable || device.usable;
    info.reason = info.usable ? "" : device.reason;
    if (info.usable) break;  // the one that a run takes
  }
  return info;
}

HapticDeviceInfo falcon_info() {
  constexpr std::array ids{falcon::kUsbId};
  HapticDeviceInfo info = usb_info("falcon", "Novint Falcon, 3 forces", ids);
  if (!info.usable) return info;
  auto port = falcon::open_first_falcon();
  info.what += port && falcon::runs_firmware(std::move(*port))
                   ? "; its firmware runs"
                   : "; firmware missing: name your file with --firmware";
  return info;
}

HapticDeviceInfo inverse3_info() {
  HapticDeviceInfo info{"inverse3", "Haply Inverse3, 3 forces, through its maker's service", false, ""};
  const auto service = inverse3::connect(inverse3::kServicePort);
  info.usable = static_cast<bool>(service);
  if (service)
    info.what += service->session.grip.empty() ? "; without a grip" : "; its grip turns the tool";
  else
    info.reason = service.error().sentence;
  return info;
}

/// The port of "inverse3" or "inverse3:PORT"; nothing where it is neither.
std::optional<std::uint16_t> inverse3_port(std::string_view name) {
  constexpr std::string_view driver = "inverse3";
  if (!name.starts_with(driver)) return std::nullopt;
  name.remove_prefix(driver.size());
  if (name.empty()) return inverse3::kServicePort;
  std::uint16_t port = 0;
  const char* end = name.data() + name.size();
  const auto read = std::from_chars(name.data() + 1, end, port);
  const bool whole = name.front() == ':' && read.ec == std::errc() && read.ptr == end && port != 0;
  return whole ? std::optional(port) : std::nullopt;
}

}  // namespace

std::vector<HapticDeviceInfo> list_haptic_devices() {
  return {
      {"simulated", "a hand that follows the scene's path, in real or virtual time", true, ""},
      falcon_info(),
      inverse3_info(),
      usb_info("spacemouse", "3Dconnexion SpaceMouse, 6 axes in, no force", spacemouse::kModels),
      {"replay", "a recorded trace.csv of any device: --device replay:FILE", true, ""},
  };
}

Result<std::unique_ptr<HapticDevice>> make_haptic_device(const std::string& name,
                                                         const DeviceSettings& settings, const Pose& start,
                                                         const Vec3& tool_gc_m, const std::string& firmware) {
  if (name == "simulated") return make_simulated_device(settings, start, tool_gc_m);
  if (name == "falcon") {
    falcon::FalconSettings falcon;
    falcon.firmware = firmware;
    falcon.workspace = settings.workspace;
    return falcon::make_falcon(falcon, start);
  }
  if (const auto port = inverse3_port(name))
    return inverse3::make_inverse3({.port = *port, .workspace = settings.workspace}, start);
  if (name == "spacemouse")
    return spacemouse::make_spacemouse({.rate = {}, .workspace = settings.workspace}, start);
  if (name == "replay") {
    if (settings.replay_file.empty())
      return bad_value(
          "haptic device 'replay' needs a recorded trace: --device replay:FILE, or the scene's device.path "
          "beside \"driver\": \"replay\"");
    return replay::make_replay(settings.replay_file, settings.max_force_n, settings.max_torque_nm);
  }
  return Error{ErrorCode::kUsage, "unknown haptic device '" + name +
                                      "', known are simulated, falcon, inverse3, spacemouse, replay"};
}

}  // namespace palpate
