#include "compute/vulkan/command_recorder.h"

#include <array>
#include <chrono>
#include <utility>

namespace palpate {
namespace {
constexpr std::uint32_t kMostBindings = 32;
// How long a GPU is asked again and again before the thread sleeps (chosen: a short frame is over by then).
constexpr std::chrono::microseconds kSpin{500};
}  // namespace

Result<CommandRecorder> CommandRecorder::create(VulkanDevice& device, std::uint32_t stages) {
  CommandRecorder out;
  out.device_ = &device;
  out.stage_limit_ = stages;
  out.max_groups_ = device.limits().groups;
  out.stages_.reserve(stages);
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = device.queue_family();
  if (const VkResult r = vkCreateCommandPool(device.handle(), &pool, nullptr, &out.pool_); r != VK_SUCCESS)
    return vulkan_error("vkCreateCommandPool", r);
  VkCommandBufferAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = out.pool_;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  if (const VkResult r = vkAllocateCommandBuffers(device.handle(), &allocate, &out.commands_);
      r != VK_SUCCESS)
    return vulkan_error("vkAllocateCommandBuffers", r);
  VkFenceCreateInfo fence{};
  fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
  if (const VkResult r = vkCreateFence(device.handle(), &fence, nullptr, &out.fence_); r != VK_SUCCESS)
    return vulkan_error("vkCreateFence", r);
  if (stages > 0) {
    VkQueryPoolCreateInfo queries{};
    queries.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = stages + 1;
    if (const VkResult r = vkCreateQueryPool(device.handle(), &queries, nullptr, &out.queries_);
        r != VK_SUCCESS)
      return vulkan_error("vkCreateQueryPool", r);
  }
  return out;
}

CommandRecorder::~CommandRecorder() {
  if (device_ == nullptr) return;
  if (pending_) device_->wait_idle();  // submitted and never waited for
  vkDestroyQueryPool(device_->handle(), queries_, nullptr);
  vkDestroyFence(device_->handle(), fence_, nullptr);
  vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

CommandRecorder::CommandRecorder(CommandRecorder&& other) noexcept { *this = std::move(other); }

CommandRecorder& CommandRecorder::operator=(CommandRecorder&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(pool_, other.pool_);
  std::swap(commands_, other.commands_);
  std::swap(fence_, other.fence_);
  std::swap(queries_, other.queries_);
  std::swap(stage_limit_, other.stage_limit_);
  std::swap(max_groups_, other.max_groups_);
  std::swap(stages_, other.stages_);
  std::swap(refused_, other.refused_);
  std::swap(dispatches_, other.dispatches_);
  std::swap(barriers_, other.barriers_);
  std::swap(recording_, other.recording_);
  std::swap(pending_, other.pending_);
  return *this;
}

void CommandRecorder::begin() {
  VkCommandBufferBeginInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  vkBeginCommandBuffer(commands_,
                       &info);  // resets; its only failures are out-of-memory, which end() reports again
  stages_.clear();
  refused_.reset();
  dispatches_ = barriers_ = 0;
  if (queries_ != VK_NULL_HANDLE) vkCmdResetQueryPool(commands_, queries_, 0, stage_limit_ + 1);
  recording_ = true;
}

bool CommandRecorder::bind(const ComputePipeline& pipeline, std::span<const BufferView> buffers,
                           const void* push, std::uint32_t push_bytes) {
  assert(buffers.size() == pipeline.buffers() && buffers.size() <= kMostBindings &&
         push_bytes == pipeline.push_bytes());
  if (auto made = pipeline.wait(); !made) {
    if (!refused_) refused_ = made.error();
    return false;
  }
  ++dispatches_;
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
  std::array<VkDescriptorBufferInfo, kMostBindings> infos{};
  std::array<VkWriteDescriptorSet, kMostBindings> writes{};
  const auto count = static_cast<std::uint32_t>(buffers.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    infos[i] = {buffers[i].buffer, buffers[i].offset, buffers[i].bytes};
    writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = pipeline.kinds().of(i);
    writes[i].pTexelBufferView = &buffers[i].texels;
    writes[i].pBufferInfo = &infos[i];
  }
  if (count > 0)
    device_->push_descriptors(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.layout(), 0, count,
                              writes.data());
  if (push_bytes > 0)
    vkCmdPushConstants(commands_, pipeline.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes, push);
  return true;
}

void CommandRecorder::dispatch_raw(const ComputePipeline& pipeline, std::span<const BufferView> buffers,
                                   const void* push, std::uint32_t push_bytes, std::uint32_t x,
                                   std::uint32_t y, std::uint32_t z) {
  if (bind(pipeline, buffers, push, push_bytes)) vkCmdDispatch(commands_, x, y, z);
}

void CommandRecorder::barrier(VkPipelineStageFlags2 more_stages, VkAccessFlags2 more_access) {
  ++barriers_;
  VkMemoryBarrier2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  memory.srcStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
                        VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
  memory.srcAccessMask = VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
  memory.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
                        VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | more_stages;
  memory.dstAccessMask = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT |
                         VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT |
                         VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | more_access;
  VkDependencyInfo dependency{};
  dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &dependency);
}

void CommandRecorder::fill(VkBuffer buffer, std::uint32_t word, std::uint64_t offset, std::uint64_t bytes) {
  vkCmdFillBuffer(commands_, buffer, offset, bytes, word);
}

void CommandRecorder::copy(VkBuffer from, std::uint64_t from_offset, VkBuffer to, std::uint64_t to_offset,
                           std::uint64_t bytes) {
  if (bytes == 0) return;
  const VkBufferCopy region{from_offset, to_offset, bytes};
  vkCmdCopyBuffer(commands_, from, to, 1, &region);
}

void CommandRecorder::stage(const char* name) {
  if (queries_ == VK_NULL_HANDLE) return;
  assert(stages_.size() < stage_limit_);
  vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_,
                       static_cast<std::uint32_t>(stages_.size()));
  stages_.push_back(name);
}

Result<void> CommandRecorder::end() {
  if (!recording_) return {};
  if (!stages_.empty())
    vkCmdWriteTimestamp2(commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, queries_,
                         static_cast<std::uint32_t>(stages_.size()));
  barrier(VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);  // of what shaders and copies wrote
  recording_ = false;
  if (const VkResult r = vkEndCommandBuffer(commands_); r != VK_SUCCESS)
    return vulkan_error("vkEndCommandBuffer", r);
  if (refused_) return *refused_;
  return device_->take_validation_error();
}

Result<void> CommandRecorder::submit() {
  vkResetFences(device_->handle(), 1, &fence_);
  VkCommandBufferSubmitInfo commands{};
  commands.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  commands.commandBuffer = commands_;
  VkSubmitInfo2 info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  VkResult submitted = device_->injected(GpuFault::Call::kSubmit);
  if (submitted == VK_SUCCESS) submitted = device_->submit(info, fence_);
  if (submitted != VK_SUCCESS) return vulkan_error("vkQueueSubmit2", submitted);
  pending_ = true;
  return {};
}

Result<void> CommandRecorder::wait(std::uint64_t timeout_ns) {
  VkResult waited = device_->injected(GpuFault::Call::kWait);
  if (waited == VK_SUCCESS && !device_->unified()) spin();
  if (waited == VK_SUCCESS) waited = vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, timeout_ns);
  pending_ = false;
  if (waited != VK_SUCCESS) {
    device_->wait_idle();  // whoever hears of the failure will destroy what may still be in use
    return vulkan_error("vkWaitForFences", waited);
  }
  return device_->take_validation_error();
}

void CommandRecorder::spin() const {
  const auto end = std::chrono::steady_clock::now() + kSpin;
  while (vkGetFenceStatus(device_->handle(), fence_) == VK_NOT_READY &&
         std::chrono::steady_clock::now() < end) {
  }
}

Result<void> CommandRecorder::submit_and_wait() {
  if (auto r = end(); !r) return r;
  if (auto r = submit(); !r) return r;
  return wait(600'000'000'000);
}

Result<void> CommandRecorder::times(std::vector<StageTime>& out) const {
  out.clear();
  if (stages_.empty()) return {};
  std::array<std::uint64_t, 65> ticks{};
  assert(stages_.size() < ticks.size());
  const auto count = static_cast<std::uint32_t>(stages_.size() + 1);
  if (const VkResult r = vkGetQueryPoolResults(device_->handle(), queries_, 0, count, sizeof ticks,
                                               ticks.data(), 8, VK_QUERY_RESULT_64_BIT);
      r != VK_SUCCESS)
    return vulkan_error("vkGetQueryPoolResults", r);
  for (std::size_t i = 0; i < stages_.size(); ++i)
    out.push_back(
        {stages_[i], static_cast<double>(ticks[i + 1] - ticks[i]) * device_->limits().timestamp_ns * 1e-3});
  return {};
}

}  // namespace palpate
