#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compute/vulkan/options.h"
#include "model/cache/disk_cache.h"
#include "model/collision_backend.h"

namespace palpate {

/// Options of the engine `gpu`, beside its device's.
struct GpuOptions : DeviceOptions {
  std::shared_ptr<DiskCache> cache{};  ///< where prepared scenes are kept; may be null
  std::map<std::string, std::uint32_t>
      first_capacity{};  ///< for tests: items that a list of a frame holds to begin with, by its name in
                         ///< Contacts::truncated_capacity; lists not named here choose for themselves
};

/// The device engine: every decision by shaders, on any Vulkan device, lavapipe too. Error (kNoDevice) with
/// the reason for each device that was refused. Call before any thread exists: on lavapipe it sets an
/// environment variable.
Result<std::unique_ptr<CollisionBackend>> make_gpu_backend(const GpuOptions& options);

/// All Vulkan devices, usable or with the reason why not.
std::vector<VulkanDeviceInfo> list_vulkan_devices();

}  // namespace palpate
