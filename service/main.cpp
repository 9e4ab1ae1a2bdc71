// The program `palpate`: gives the engines (service/engines.h) and the devices (driver/device_list.h, which
// alone knows every driver by name) to the command line (service/cli/cli.h).
#include <string>

#include "compute/gpu/gpu_backend.h"
#include "driver/device_list.h"
#include "service/bench/time/peer.h"
#include "service/cli/cli.h"
#include "service/engines.h"

namespace {

using namespace palpate;

std::vector<DeviceLine> list_devices() {
  std::vector<DeviceLine> lines;
  const std::vector<VulkanDeviceInfo> vulkan = list_vulkan_devices();
  if (vulkan.empty())
    if (const auto none = make_gpu_backend({}); !none)
      lines.push_back({"vulkan", "none", false, none.error().sentence});
  for (const VulkanDeviceInfo& device : vulkan)
    lines.push_back({"vulkan", device.name, device.usable, device.usable ? device.driver : device.reason});
  for (const HapticDeviceInfo& device : list_haptic_devices())
    lines.push_back({"haptic", device.name, device.usable, device.usable ? device.what : device.reason});
  return lines;
}

Result<std::unique_ptr<HapticDevice>> make_device(const std::string& name, const Scene& scene,
                                                  const Vec3& tool_gc_m, const std::string& firmware) {
  auto device = make_haptic_device(name, scene.device, scene.start, tool_gc_m, firmware);
  if (!device && device.error().code == ErrorCode::kUsage) return bad_value(device.error().sentence);
  return device;
}

}  // namespace

int main(int argc, char** argv) {
  palpate::Parts parts = palpate::engine_parts();
  parts.make_device = make_device;
  parts.list_devices = list_devices;
#ifdef PALPATE_BENCH_PEERS
  parts.make_peers = palpate::make_peers;
  parts.make_judge = palpate::make_judge;
  parts.make_question_peers = palpate::make_question_peers;
#endif
  return palpate::command_line(argc, argv, parts);
}
