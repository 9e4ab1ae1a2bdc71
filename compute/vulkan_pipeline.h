#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>

#include "compute/vulkan_device.h"
#include "model/result.h"
#include "shaders/shared/shader_code.h"

namespace palpate {

/// One specialisation constant: 32 bits at `id`.
struct SpecConstant {
  std::uint32_t id;
  std::uint32_t value;
};

/// A compute pipeline whose set 0 is `buffers` storage buffers, bindings 0 … buffers − 1 (push descriptors),
/// with `push_bytes` of push constants. Movable.
class ComputePipeline {
 public:
  ComputePipeline() = default;
  static Result<ComputePipeline> create(VulkanDevice& device, const ShaderCode& code, std::uint32_t buffers,
                                        std::uint32_t push_bytes = 0, std::span<const SpecConstant> constants = {});
  ~ComputePipeline();
  ComputePipeline(ComputePipeline&& other) noexcept;
  ComputePipeline& operator=(ComputePipeline&& other) noexcept;
  ComputePipeline(const ComputePipeline&) = delete;
  ComputePipeline& operator=(const ComputePipeline&) = delete;

  VkPipeline handle() const { return pipeline_; }
  VkPipelineLayout layout() const { return layout_; }
  std::uint32_t buffers() const { return buffers_; }
  std::uint32_t push_bytes() const { return push_bytes_; }
  const char* name() const { return name_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  std::uint32_t buffers_ = 0;
  std::uint32_t push_bytes_ = 0;
  const char* name_ = "";
};

/// Makes the driver compile now what it would compile at the first dispatch: runs each pipeline on zero workgroups.
Result<void> warm_up(VulkanDevice& device, std::span<const ComputePipeline* const> pipelines);

}  // namespace palpate
