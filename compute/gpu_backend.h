#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "model/collision_backend.h"

namespace palpate {

struct GpuOptions {
  std::string device;             ///< part of a device's name; empty: the best usable one
  bool validation = false;        ///< validation layer with synchronisation checks; a message is an error
  bool guard_buffers = false;     ///< for tests: prepare and query fail when anything was written beyond a buffer's ends
  bool inline_execution = true;   ///< on lavapipe, run on the submitting thread (LP_NUM_THREADS=0); see docs
};

/// A Vulkan device and why it can or can't be used.
struct VulkanDeviceInfo {
  std::string name, driver;
  bool usable = false;
  std::string reason;   ///< one sentence
};

/// The Vulkan back end. Error (kNoDevice) with the reason for each device that was refused.
/// Call before any thread exists: on lavapipe it sets an environment variable.
Result<std::unique_ptr<CollisionBackend>> make_gpu_backend(const GpuOptions& options);

std::vector<VulkanDeviceInfo> list_vulkan_devices();

}  // namespace palpate
