// The one place that knows every back end by name.
#include "service/engines.h"

#include <algorithm>

#include "compute/gpu/gpu_backend.h"
#include "compute/native/native_backend.h"
#include "cpu_ref/ref_backend.h"

namespace palpate {

Parts engine_parts() {
  const auto folder = DiskCache::usual_folder();
  const auto cache = folder ? std::make_shared<DiskCache>(DiskCache::Settings{.folder = *folder}) : nullptr;
  Parts parts;
  parts.make_gpu = [cache](bool cached) {
    GpuOptions options;
    options.cache = cached ? cache : nullptr;
    return make_gpu_backend(options);
  };
  parts.make_cpu = [cache](bool cached) { return make_native_backend(cached ? cache : nullptr); };
  parts.make_ref = make_ref_backend;
  parts.has_gpu = [] {
    const auto devices = list_vulkan_devices();
    return std::any_of(devices.begin(), devices.end(),
                       [](const auto& device) { return device.usable && !device.processor; });
  };
  parts.cache = cache;
  return parts;
}

}  // namespace palpate
