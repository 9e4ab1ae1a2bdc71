// The program: the one place that knows every back end and driver by name.
#include <algorithm>
#include <string>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"
#include "driver/device_list.h"
#include "service/bench/time/peer.h"
#include "service/cli/cli.h"

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
  const auto folder = palpate::DiskCache::usual_folder();
  const auto cache =
      folder ? std::make_shared<palpate::DiskCache>(palpate::DiskCache::Settings{.folder = *folder})
             : nullptr;
  const palpate::Parts parts{
      .make_gpu =
          [&cache](bool cached) {
            palpate::GpuOptions options;
            options.cache = cached ? cache : nullptr;
            return palpate::make_gpu_backend(options);
          },
      .make_cpu = [&cache](bool cached) { return palpate::make_native_backend(cached ? cache : nullptr); },
      .make_ref = palpate::make_ref_backend,
      .has_gpu =
          [] {
            const auto devices = palpate::list_vulkan_devices();
            return std::any_of(devices.begin(), devices.end(),
                               [](const auto& device) { return device.usable && !device.processor; });
          },
      .cache = cache,
      .make_device = make_device,
      .list_devices = list_devices,
#ifdef PALPATE_BENCH_PEERS
      .make_peers = palpate::make_peers,
      .make_judge = palpate::make_judge,
#else
      .make_peers = nullptr,
      .make_judge = nullptr,
#endif
  };
  return palpate::command_line(argc, argv, parts);
}
