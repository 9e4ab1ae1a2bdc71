#include "compute/vulkan_pipeline.h"

#include <array>
#include <utility>
#include <vector>

#include "compute/command_recorder.h"
#include "compute/vulkan_buffer.h"

namespace palpate {

Result<ComputePipeline> ComputePipeline::create(VulkanDevice& device, const ShaderCode& code, std::uint32_t buffers,
                                                std::uint32_t push_bytes, std::span<const SpecConstant> constants) {
  ComputePipeline out;
  out.device_ = device.handle();
  out.buffers_ = buffers;
  out.push_bytes_ = push_bytes;
  out.name_ = code.name;

  std::vector<VkDescriptorSetLayoutBinding> bindings(buffers);
  for (std::uint32_t i = 0; i < buffers; ++i) {
    bindings[i] = {};
    bindings[i].binding = i;
    bindings[i].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = buffers;
  set.pBindings = bindings.data();
  if (const VkResult r = vkCreateDescriptorSetLayout(out.device_, &set, nullptr, &out.set_layout_); r != VK_SUCCESS)
    return vulkan_error("vkCreateDescriptorSetLayout", r);

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &out.set_layout_;
  layout.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
  layout.pPushConstantRanges = &push;
  if (const VkResult r = vkCreatePipelineLayout(out.device_, &layout, nullptr, &out.layout_); r != VK_SUCCESS)
    return vulkan_error("vkCreatePipelineLayout", r);

  VkShaderModuleCreateInfo module{};
  module.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module.codeSize = code.bytes;
  module.pCode = code.words;
  VkShaderModule shader = VK_NULL_HANDLE;
  if (const VkResult r = vkCreateShaderModule(out.device_, &module, nullptr, &shader); r != VK_SUCCESS)
    return vulkan_error("vkCreateShaderModule", r);

  std::vector<VkSpecializationMapEntry> entries;
  std::vector<std::uint32_t> values;
  for (const SpecConstant& c : constants) {
    entries.push_back({c.id, static_cast<std::uint32_t>(values.size() * 4), 4});
    values.push_back(c.value);
  }
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(), values.size() * 4,
                                            values.data()};
  VkComputePipelineCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = shader;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &specialisation;
  create.layout = out.layout_;
  const VkResult made = vkCreateComputePipelines(out.device_, VK_NULL_HANDLE, 1, &create, nullptr, &out.pipeline_);
  vkDestroyShaderModule(out.device_, shader, nullptr);
  if (made != VK_SUCCESS) return vulkan_error("vkCreateComputePipelines", made);
  // A module that the layout does not fit is a bug of ours that the layer finds here.
  if (auto r = device.take_validation_error(); !r)
    return Error{ErrorCode::kInternal, std::string("shader ") + code.name + ": " + r.error().sentence};
  return out;
}

ComputePipeline::~ComputePipeline() {
  if (device_ == VK_NULL_HANDLE) return;
  vkDestroyPipeline(device_, pipeline_, nullptr);
  vkDestroyPipelineLayout(device_, layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_, set_layout_, nullptr);
}

ComputePipeline::ComputePipeline(ComputePipeline&& other) noexcept { *this = std::move(other); }

ComputePipeline& ComputePipeline::operator=(ComputePipeline&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(set_layout_, other.set_layout_);
  std::swap(layout_, other.layout_);
  std::swap(pipeline_, other.pipeline_);
  std::swap(buffers_, other.buffers_);
  std::swap(push_bytes_, other.push_bytes_);
  std::swap(name_, other.name_);
  return *this;
}

Result<void> warm_up(VulkanDevice& device, std::span<const ComputePipeline* const> pipelines) {
  auto dummy = VulkanBuffer::create(device, "warm-up", 256, BufferKind::kDevice);
  if (!dummy) return dummy.error();
  auto recorder = CommandRecorder::create(device);
  if (!recorder) return recorder.error();
  recorder->begin();
  const std::array<std::uint32_t, 32> zero{};
  for (const ComputePipeline* pipeline : pipelines) {
    const std::vector<BufferView> buffers(pipeline->buffers(), BufferView(*dummy));
    recorder->dispatch_raw(*pipeline, buffers, zero.data(), pipeline->push_bytes(), 0, 1, 1);
    recorder->barrier();   // one dummy buffer stands for all
  }
  return recorder->submit_and_wait();
}

}  // namespace palpate
