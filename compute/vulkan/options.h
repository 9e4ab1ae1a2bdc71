#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

namespace palpate {

/// Makes calls to the device fail, so that tests see what follows. May be set at any time, by any thread.
struct GpuFault {
  /// Which kind of call fails.
  enum class Call : std::uint8_t { kNone, kAllocate, kSubmit, kWait };
  std::atomic<Call> call{Call::kNone};  ///< kAllocate: out of device memory; the others: device lost
  std::atomic<std::int64_t> after{0};   ///< so many of these calls succeed; then all fail
};

/// Which Vulkan device is taken, and how it is watched.
struct DeviceOptions {
  std::string device;       ///< part of a device's name; empty: the best usable one
  bool validation = false;  ///< validation layer with synchronisation checks; a message is an error
  bool guard_buffers =
      false;  ///< for tests: every buffer lies between guard bytes, and writing there is an error
  bool inline_execution = true;  ///< on lavapipe, run on the submitting thread (LP_NUM_THREADS=0)
  bool own_memory = false;  ///< for tests: the host's own processor, or an integrated GPU, is taken for a GPU
                            ///< with memory of its own
  std::shared_ptr<GpuFault> fault{};  ///< for tests
};

/// A Vulkan device and why it can or can't be used.
struct VulkanDeviceInfo {
  std::string name, driver;
  bool usable = false;
  bool processor = false;  ///< the host's own: lavapipe
  std::string reason;      ///< one sentence
};

}  // namespace palpate
