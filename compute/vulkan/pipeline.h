#pragma once
#include <vulkan/vulkan.h>

#include <cstdint>
#include <future>
#include <memory>
#include <span>

#include "compute/vulkan/device.h"
#include "model/result.h"
#include "shaders/shared/shader_code.h"

namespace palpate {

/// One specialisation constant: 32 bits at `id`.
struct SpecConstant {
  std::uint32_t id;
  std::uint32_t value;
};

/// How a shader sees its buffers, a bit a binding: as uniform buffers, as texels
/// (VulkanBuffer::texels()), all others as storage buffers.
struct BindingKinds {
  std::uint32_t uniform = 0, texels = 0;
  VkDescriptorType of(std::uint32_t binding) const {
    return (uniform >> binding & 1u) != 0  ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER
           : (texels >> binding & 1u) != 0 ? VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER
                                           : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  }
};

/// What the driver made of one module with one choice of constants.
struct PipelineObjects {
  VkDevice device = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline pipeline = VK_NULL_HANDLE;
  explicit PipelineObjects(VkDevice of) : device(of) {}
  PipelineObjects(const PipelineObjects&) = delete;
  PipelineObjects& operator=(const PipelineObjects&) = delete;
  ~PipelineObjects();
};

/// A pipeline that is being made.
struct PendingPipeline {
  Compilers* by;  ///< the device's
  std::shared_future<Result<std::shared_ptr<const PipelineObjects>>> made;
};

/// A compute pipeline whose set 0 is `buffers` buffers, bindings 0 … buffers − 1 (push descriptors), with
/// `push_bytes` of push constants.
/// Copies share what the driver made; so do all that one device was ever asked for with the same module and
/// constants, so that a second scene compiles nothing. create() comes back at once: the driver works on while
/// pipelines are asked for, several at a time, and wait() tells what came of it.
class ComputePipeline {
 public:
  ComputePipeline() = default;
  static Result<ComputePipeline> create(VulkanDevice& device, const ShaderCode& code, std::uint32_t buffers,
                                        std::uint32_t push_bytes = 0,
                                        std::span<const SpecConstant> constants = {},
                                        BindingKinds kinds = {});

  /// Waits until the pipeline is there; makes the compilers begin. An error: the driver refused, or the
  /// module does not fit.
  Result<void> wait() const;
  VkPipeline handle() const { return objects().pipeline; }      ///< after wait() has succeeded
  VkPipelineLayout layout() const { return objects().layout; }  ///< likewise
  std::uint32_t buffers() const { return buffers_; }
  std::uint32_t push_bytes() const { return push_bytes_; }
  BindingKinds kinds() const { return kinds_; }
  const char* name() const { return name_; }

 private:
  const PipelineObjects& objects() const { return **made_->made.get(); }

  std::shared_ptr<const PendingPipeline> made_;
  std::uint32_t buffers_ = 0;
  std::uint32_t push_bytes_ = 0;
  BindingKinds kinds_;
  const char* name_ = "";
};

/// Makes the driver compile now what it would compile at the first dispatch: runs each pipeline on zero
/// workgroups.
Result<void> warm_up(VulkanDevice& device, std::span<const ComputePipeline* const> pipelines);

}  // namespace palpate
