#pragma once
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "compute/vulkan/compilers.h"
#include "compute/vulkan/options.h"
#include "model/result.h"

namespace palpate {

class BufferGuard;
struct PendingPipeline;

/// The sentence for a Vulkan call that failed: "vkQueueSubmit2 failed: device lost".
Error vulkan_error(const char* call, VkResult result);

/// An instance, one device and its one compute queue. Everything made from it must die first.
/// One thread at a time, but that several may make and drop buffers, record, submit and wait, each with
/// recorders of its own.
class VulkanDevice {
 public:
  struct Limits {
    std::uint64_t storage_range = 0;  ///< bytes that one binding may span
    std::uint64_t allocation = 0;     ///< bytes of the largest buffer
    std::uint64_t heap = 0;           ///< bytes of the device-local heap
    std::uint32_t groups = 0;         ///< workgroups along x
    double timestamp_ns = 0;          ///< nanoseconds a tick
  };

  /// Error (kNoDevice): one sentence with the reason for every device that was refused.
  static Result<std::unique_ptr<VulkanDevice>> create(const DeviceOptions& options);
  /// All devices and why each can't be used; an empty list when there is no Vulkan at all.
  static std::vector<VulkanDeviceInfo> list();
  ~VulkanDevice();
  VulkanDevice(const VulkanDevice&) = delete;
  VulkanDevice& operator=(const VulkanDevice&) = delete;

  VkDevice handle() const { return device_; }
  /// vkQueueSubmit2 and vkDeviceWaitIdle, one thread after the other.
  VkResult submit(const VkSubmitInfo2& info, VkFence fence);
  void wait_idle();
  std::uint32_t queue_family() const { return queue_family_; }
  const Limits& limits() const { return limits_; }
  const std::string& name() const { return name_; }
  const std::string& driver() const { return driver_; }  ///< its name and version
  /// Device memory is host memory (lavapipe, integrated GPUs): buffers are written in place, without staging.
  bool unified() const { return unified_; }

  /// The device is the host's own processor (lavapipe).
  bool processor() const { return processor_; }

  /// Shaders look things up in texel buffers (shaders/lib/frame.glsl): llvmpipe takes a texel in one piece.
  bool texels() const { return texels_; }

  /// Buffers lie in host memory that several devices may import at once (lavapipe): what one has made,
  /// another can use without a copy.
  bool shares_memory() const { return page_ != 0; }
  /// Alignment of such memory, bytes.
  std::uint64_t page() const { return page_; }

  /// Index of a memory type with all of `wanted`, preferring those that have `preferred` too; or −1.
  int memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const;

  /// vkCmdPushDescriptorSetKHR, an extension's function.
  PFN_vkCmdPushDescriptorSetKHR push_descriptors = nullptr;

  /// Success, or the first message of the validation layer since the last call of this.
  Result<void> take_validation_error();

  /// VK_SUCCESS, or what DeviceOptions::fault wants this call to come to.
  VkResult injected(GpuFault::Call call);

  /// Bytes of device memory now held by buffers.
  std::atomic<std::uint64_t> allocated{0};
  /// The most that this has been.
  std::atomic<std::uint64_t> most_allocated{0};

  /// Copies of buffers for the host, as long as somebody has them (HostCopy).
  std::map<VkBuffer, std::weak_ptr<std::vector<std::uint64_t>>> host_copies;

  /// Pipelines made or being made, by module and constants; ComputePipeline::create fills it.
  std::map<std::vector<std::uint32_t>, std::shared_ptr<PendingPipeline>> pipelines;
  /// Makes them, while whoever asked goes on.
  std::unique_ptr<Compilers> compilers = std::make_unique<Compilers>();

  /// For benches: told how long each shader that its owner watches took on how many items; may be empty.
  std::function<void(const char* kernel, std::uint64_t items, double seconds)> kernel_watch;

  /// For tests: every buffer lies between guard bytes and starts with bytes that are not zero. `guards`: of
  /// the buffers that live; `guard_error`: the first that was found broken when its buffer died, or empty.
  bool guarded = false;
  std::mutex guard_mutex;  ///< of the next two, while several threads make and drop buffers; check_guards()
                           ///< wants to be alone
  std::set<BufferGuard*> guards;
  std::string guard_error;
  /// Success, or a sentence that names a buffer that something wrote beyond. Nothing when not `guarded`.
  Result<void> check_guards();

 private:
  VulkanDevice() = default;
  Result<void> make_instance(bool validation);
  Result<void> choose(const std::string& wanted);
  Result<void> make_device(bool own_memory);
  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT types,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data,
                                                   void* user);

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::mutex queue_mutex_;
  std::uint32_t queue_family_ = 0;
  VkPhysicalDeviceMemoryProperties memory_{};
  Limits limits_;
  std::string name_, driver_;
  bool unified_ = false;
  bool processor_ = false;
  bool texels_ = false;
  std::uint64_t page_ = 0;  ///< 0: does not share memory
  std::shared_ptr<GpuFault> fault_;
  std::mutex message_mutex_;
  std::string message_;
};

}  // namespace palpate
