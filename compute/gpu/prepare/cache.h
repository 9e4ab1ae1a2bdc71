#pragma once
#include <optional>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/vulkan/device.h"
#include "model/cache/disk_cache.h"

namespace palpate {

/// Key of all that preparation depends on: program, device and driver, geometry, profile.
ContentKey prepared_key(const VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan);

/// The scene as an earlier preparation of this geometry and plan left it, put on the device again. Empty:
/// there is none, or the device has no room (preparing says so then).
std::optional<PreparedScene> find_prepared(VulkanDevice& device, DiskCache& cache, const ContentKey& key,
                                           const SceneGeometry& geometry, const Plan& plan);

/// `seconds`: what preparing took.
void keep_prepared(VulkanDevice& device, DiskCache& cache, const ContentKey& key, const PreparedScene& scene,
                   double seconds);

}  // namespace palpate
