#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class VulkanDevice;

/// Canaries for tests (GpuOptions::guard_buffers): bytes before and behind a buffer in its own memory, which
/// nobody may write, and contents that are not zero to begin with. Those behind lie within what shaders can
/// reach, for many drivers drop writes beyond a binding. Registered with its device while it lives; checks
/// itself once more when it dies.
class BufferGuard {
 public:
  /// `memory`: kBytes before the buffer (rounded up to `alignment`, see before()), `bytes` of it, kBytes
  /// behind. `mapped`: the memory's host address, or null.
  BufferGuard(VulkanDevice& device, std::string what, VkDeviceMemory memory, void* mapped,
              std::uint64_t before, std::uint64_t bytes);
  ~BufferGuard();
  BufferGuard(const BufferGuard&) = delete;
  BufferGuard& operator=(const BufferGuard&) = delete;

  static constexpr std::uint64_t kBytes = 256;
  static std::uint64_t before(std::uint64_t alignment) {
    return (kBytes + alignment - 1) / alignment * alignment;
  }

  /// A sentence if a guard byte has changed.
  std::optional<std::string> broken();

 private:
  bool read(std::uint64_t from, std::vector<std::uint8_t>& bytes);

  VulkanDevice& device_;
  std::string what_;
  VkDeviceMemory memory_;
  std::uint8_t* mapped_;
  std::uint64_t before_, bytes_;
  VkBuffer whole_ = VK_NULL_HANDLE;  ///< guards and buffer, where the host can't see the memory
};

}  // namespace palpate
