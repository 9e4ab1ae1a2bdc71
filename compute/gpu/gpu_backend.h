#pragma once
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/cache/disk_cache.h"
#include "model/collision_backend.h"

namespace palpate {

/// Makes calls to the device fail, so that tests see what follows. May be set at any time, by any thread.
struct GpuFault {
  enum class Call : std::uint8_t { kNone, kAllocate, kSubmit, kWait };
  std::atomic<Call> call{Call::kNone};    ///< kAllocate: out of device memory; the others: device lost
  std::atomic<std::int64_t> after{0};     ///< so many of these calls succeed; then all fail
};

/// How much of a contact the host works out; what it leaves the device does. No choice changes a bit.
enum class HostShare : std::uint8_t {
  kNear,       ///< lists of what is near
  kContacts,   ///< all of it in `refined`; in preparation the mock-up's samples, too
};

struct GpuOptions {
  std::string device;             ///< part of a device's name; empty: the best usable one
  bool validation = false;        ///< validation layer with synchronisation checks; a message is an error
  bool guard_buffers = false;     ///< for tests: prepare and query fail when anything was written beyond a buffer's ends
  bool inline_execution = true;   ///< on lavapipe, run on the submitting thread (LP_NUM_THREADS=0); see docs
  std::shared_ptr<DiskCache> cache{};   ///< where prepared scenes are kept; may be null
  std::map<std::string, std::uint32_t> first_capacity{};   ///< for tests: items that a list of a frame holds to begin with, by its name in
                                                           ///< Contacts::truncated_capacity; lists not named here choose for themselves
  std::optional<HostShare> host_share{};   ///< for tests; empty: kContacts where the device is the host's own processor (lavapipe), else kNear
  bool own_memory = false;             ///< for tests: the host's own processor, or an integrated GPU, is taken for a GPU with memory of its own
  std::shared_ptr<GpuFault> fault{};   ///< for tests
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
