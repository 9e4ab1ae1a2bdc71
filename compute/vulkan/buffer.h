#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <memory>
#include <string>

#include "compute/vulkan/buffer_guard.h"
#include "compute/vulkan/device.h"
#include "model/result.h"

namespace palpate {

/// Where a buffer lives. On unified devices (lavapipe) all of them are the same mapped memory.
enum class BufferKind {
  kDevice,    ///< fast for shaders; mapped only on unified devices
  kTexels,    ///< the same, which shaders see in texels of four words
  kUpload,    ///< written by the host with write(), read by shaders; the host can't read it: on a GPU that
              ///< takes a microsecond a word
  kReadback,  ///< written by shaders or copies, read by the host with as()
};

/// A storage buffer (also indirect arguments, copy source and target) with memory of its own. Movable; may be
/// empty. Host access is coherent: no flushes; the recorder's barriers include the host.
class VulkanBuffer {
 public:
  VulkanBuffer() = default;
  /// `what` names the contents in sentences ("triangle lists"). At least 4 bytes are made, rounded up to 4.
  /// Errors: larger than a shader may see, or a buffer or the device's memory may be (kBadValue); the device
  /// had no memory left (kInternal). Contents are undefined.
  static Result<VulkanBuffer> create(VulkanDevice& device, const char* what, std::uint64_t bytes,
                                     BufferKind kind);
  /// The same memory as a buffer of another device that shares host memory (VulkanDevice::shares_memory),
  /// which keeps as long as either lives.
  static Result<VulkanBuffer> alias(VulkanDevice& device, const VulkanBuffer& of);
  ~VulkanBuffer();
  VulkanBuffer(VulkanBuffer&& other) noexcept;
  VulkanBuffer& operator=(VulkanBuffer&& other) noexcept;
  VulkanBuffer(const VulkanBuffer&) = delete;
  VulkanBuffer& operator=(const VulkanBuffer&) = delete;

  VkBuffer handle() const { return buffer_; }
  /// The whole as texels, of a word but for kTexels; null where VulkanDevice::texels() isn't.
  VkBufferView texels() const { return texels_; }
  std::uint64_t bytes() const { return bytes_; }
  BufferKind kind() const { return kind_; }
  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }
  /// What the host may read in place; null for a kUpload buffer, and for a kDevice buffer of a discrete GPU.
  template <class T>
  const T* as() const {
    return kind_ == BufferKind::kUpload ? nullptr : static_cast<const T*>(mapped_);
  }
  /// Writes in place, from byte `at` on. False: this is a kDevice buffer of a discrete GPU (upload() knows
  /// how).
  bool write(std::uint64_t at, const void* data, std::uint64_t bytes) const;

 private:
  static Result<VulkanBuffer> make(VulkanDevice& device, const char* what, std::uint64_t bytes,
                                   BufferKind kind, const VulkanBuffer* of);

  VulkanDevice* device_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkBufferView texels_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  BufferKind kind_ = BufferKind::kDevice;
  std::uint64_t bytes_ = 0;
  std::uint64_t counted_ = 0;  ///< bytes in VulkanDevice::allocated; none for an alias
  void* mapped_ = nullptr;
  std::shared_ptr<void> pages_;         ///< host memory that the device imported, where it shares such
  std::unique_ptr<BufferGuard> guard_;  ///< in tests
};

/// Copies host data into any buffer and waits; through a staging buffer where it is not mapped. Not for the
/// frame.
Result<void> upload(VulkanDevice& device, const VulkanBuffer& to, const void* data, std::uint64_t bytes);

/// Copies `bytes` from offset `from` of any buffer to the host and waits. Not for the frame.
Result<void> download(VulkanDevice& device, const VulkanBuffer& buffer, std::uint64_t from, void* data,
                      std::uint64_t bytes);

}  // namespace palpate
