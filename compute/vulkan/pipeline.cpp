#include "compute/vulkan/pipeline.h"

#include <array>
#include <utility>
#include <vector>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"

namespace palpate {
namespace {

using MadePipeline = Result<std::shared_ptr<const PipelineObjects>>;

MadePipeline make_objects(VulkanDevice& device, const ShaderCode& code, std::uint32_t buffers,
                          std::uint32_t push_bytes, std::span<const SpecConstant> constants,
                          BindingKinds kinds) {
  auto out = std::make_shared<PipelineObjects>(device.handle());
  std::vector<VkDescriptorSetLayoutBinding> bindings(buffers);
  for (std::uint32_t i = 0; i < buffers; ++i) {
    bindings[i] = {};
    bindings[i].binding = i;
    bindings[i].descriptorType = kinds.of(i);
    bindings[i].descriptorCount = 1;
    bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = buffers;
  set.pBindings = bindings.data();
  if (const VkResult r = vkCreateDescriptorSetLayout(out->device, &set, nullptr, &out->set_layout);
      r != VK_SUCCESS)
    return vulkan_error("vkCreateDescriptorSetLayout", r);

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &out->set_layout;
  layout.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
  layout.pPushConstantRanges = &push;
  if (const VkResult r = vkCreatePipelineLayout(out->device, &layout, nullptr, &out->layout); r != VK_SUCCESS)
    return vulkan_error("vkCreatePipelineLayout", r);

  VkShaderModuleCreateInfo module{};
  module.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  module.codeSize = code.bytes;
  module.pCode = code.words;
  VkShaderModule shader = VK_NULL_HANDLE;
  if (const VkResult r = vkCreateShaderModule(out->device, &module, nullptr, &shader); r != VK_SUCCESS)
    return vulkan_error("vkCreateShaderModule", r);

  std::vector<VkSpecializationMapEntry> entries;
  std::vector<std::uint32_t> values;
  for (const SpecConstant& c : constants) {
    entries.push_back({c.id, static_cast<std::uint32_t>(values.size() * 4), 4});
    values.push_back(c.value);
  }
  const VkSpecializationInfo specialisation{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            values.size() * 4, values.data()};
  VkComputePipelineCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  create.stage.module = shader;
  create.stage.pName = "main";
  create.stage.pSpecializationInfo = &specialisation;
  create.layout = out->layout;
  const VkResult made =
      vkCreateComputePipelines(out->device, VK_NULL_HANDLE, 1, &create, nullptr, &out->pipeline);
  vkDestroyShaderModule(out->device, shader, nullptr);
  if (made != VK_SUCCESS)
    return Error{ErrorCode::kInternal, "the driver of " + device.name() + " can't compile shader " +
                                           code.name + " (" +
                                           vulkan_error("vkCreateComputePipelines", made).sentence + ")"};
  // A module that the layout does not fit is a bug of ours that the layer finds here.
  if (auto r = device.take_validation_error(); !r)
    return Error{ErrorCode::kInternal, std::string("shader ") + code.name + ": " + r.error().sentence};
  return std::shared_ptr<const PipelineObjects>(std::move(out));
}

}  // namespace

Result<ComputePipeline> ComputePipeline::create(VulkanDevice& device, const ShaderCode& code,
                                                std::uint32_t buffers, std::uint32_t push_bytes,
                                                std::span<const SpecConstant> constants, BindingKinds kinds) {
  std::vector<std::uint32_t> key{buffers, push_bytes, kinds.uniform, kinds.texels,
                                 static_cast<std::uint32_t>(constants.size())};
  for (const SpecConstant& c : constants) key.insert(key.end(), {c.id, c.value});
  key.insert(key.end(), code.words, code.words + code.bytes / 4);
  std::shared_ptr<PendingPipeline>& kept = device.pipelines[std::move(key)];
  if (!kept) {
    auto promise = std::make_shared<std::promise<MadePipeline>>();
    kept = std::make_shared<PendingPipeline>(
        PendingPipeline{device.compilers.get(), promise->get_future().share()});
    device.compilers->add(
        [&device, name = code.name,
         words = std::vector<std::uint32_t>(code.words, code.words + code.bytes / 4), buffers, push_bytes,
         values = std::vector<SpecConstant>(constants.begin(), constants.end()), kinds, promise] {
          promise->set_value(make_objects(device, {name, words.data(), words.size() * 4}, buffers, push_bytes,
                                          values, kinds));
        });
  }
  ComputePipeline out;
  out.made_ = kept;
  out.buffers_ = buffers;
  out.push_bytes_ = push_bytes;
  out.kinds_ = kinds;
  out.name_ = code.name;
  return out;
}

Result<void> ComputePipeline::wait() const {
  made_->by->begin();
  if (const MadePipeline& made = made_->made.get(); !made) return made.error();
  return {};
}

PipelineObjects::~PipelineObjects() {
  vkDestroyPipeline(device, pipeline, nullptr);
  vkDestroyPipelineLayout(device, layout, nullptr);
  vkDestroyDescriptorSetLayout(device, set_layout, nullptr);
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
    recorder->barrier();  // one dummy buffer stands for all
  }
  return recorder->submit_and_wait();
}

}  // namespace palpate
