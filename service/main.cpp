// The program: the one place that knows every back end and driver by name.
#include <cstdlib>
#include <string>

#include "compute/gpu/gpu_backend.h"
#include "cpu_ref/cpu_backend.h"
#include "driver/device_list.h"
#include "model/one_line.h"
#include "service/cli/cli.h"
#include "service/bench/peer.h"

namespace {

using namespace palpate;

std::vector<DeviceLine> list_devices() {
  std::vector<DeviceLine> lines;
  const std::vector<VulkanDeviceInfo> vulkan = list_vulkan_devices();
  if (vulkan.empty())
    if (const auto none = make_gpu_backend({}); !none) lines.push_back({"vulkan", "none", false, none.error().sentence});
  for (const VulkanDeviceInfo& device : vulkan)
    lines.push_back({"vulkan", device.name, device.usable, device.usable ? device.driver : device.reason});
  for (const HapticDeviceInfo& device : list_haptic_devices())
    lines.push_back({"haptic", device.name, device.usable, device.usable ? device.what : device.reason});
  return lines;
}

Result<std::unique_ptr<HapticDevice>> make_device(const std::string& name, const Scene& scene, const Vec3& tool_gc_m,
                                                  const std::string& firmware) {
  auto device = make_haptic_device(name, scene.device, scene.start, tool_gc_m, firmware);
  if (!device && device.error().code == ErrorCode::kUsage) return bad_value(device.error().sentence);
  return device;
}

/// Who decides small contacts, where PALPATE_HOST_SHARE says so (docs/PERFORMANCE.md): the device alone, for measuring and checking it.
Result<std::optional<HostShare>> wanted_host_share() {
  const char* const text = std::getenv("PALPATE_HOST_SHARE");
  const std::string name = text ? text : "";
  if (name.empty()) return std::optional<HostShare>();
  if (name == "near") return std::optional(HostShare::kNear);
  if (name == "contacts") return std::optional(HostShare::kContacts);
  return bad_value("PALPATE_HOST_SHARE is \"" + one_line(name) + "\", allowed are near and contacts");
}

}  // namespace

int main(int argc, char** argv) {
  const auto folder = palpate::DiskCache::usual_folder();
  const auto cache = folder ? std::make_shared<palpate::DiskCache>(palpate::DiskCache::Settings{.folder = *folder}) : nullptr;
  const palpate::Parts parts{
      .make_gpu =
          [&cache](bool cached) -> palpate::Result<std::unique_ptr<palpate::CollisionBackend>> {
            palpate::GpuOptions options;
            const auto share = wanted_host_share();
            if (!share) return share.error();
            options.host_share = *share;
            options.cache = cached ? cache : nullptr;
            return palpate::make_gpu_backend(options);
          },
      .make_cpu = palpate::make_cpu_backend,
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
