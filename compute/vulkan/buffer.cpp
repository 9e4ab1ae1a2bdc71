#include "compute/vulkan/buffer.h"

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "compute/vulkan/command_recorder.h"

namespace palpate {
namespace {

std::string mebibytes(std::uint64_t bytes) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f MiB", static_cast<double>(bytes) / 1048576.0);
  return text;
}

}  // namespace

Result<VulkanBuffer> VulkanBuffer::create(VulkanDevice& device, const char* what, std::uint64_t bytes,
                                          BufferKind kind) {
  return make(device, what, std::max<std::uint64_t>(4, (bytes + 3) & ~std::uint64_t{3}), kind, nullptr);
}

Result<VulkanBuffer> VulkanBuffer::alias(VulkanDevice& device, const VulkanBuffer& of) {
  if (!of.pages_ || !device.shares_memory())
    return Error{ErrorCode::kInternal, "a buffer of " + device.name() + " can't be shared"};
  return make(device, "a shared buffer", of.bytes_, of.kind_, &of);
}

Result<VulkanBuffer> VulkanBuffer::make(VulkanDevice& device, const char* what, std::uint64_t bytes,
                                        BufferKind kind, const VulkanBuffer* of) {
  const auto& limits = device.limits();
  if (bytes > limits.storage_range)
    return bad_value(std::string(what) + " need " + mebibytes(bytes) + ", more than the " +
                     mebibytes(limits.storage_range) + " that a shader may see in one buffer on " +
                     device.name());
  if (of == nullptr && (bytes > limits.allocation || device.allocated + bytes > limits.heap))
    return bad_value(std::string(what) + " need " + mebibytes(bytes) + " beside " +
                     mebibytes(device.allocated) + " in use, more than the " + mebibytes(limits.heap) +
                     " of memory of " + device.name());

  VulkanBuffer out;
  out.device_ = &device;
  out.kind_ = kind;
  out.bytes_ = bytes;
  const bool shares = device.shares_memory();
  VkExternalMemoryBufferCreateInfo external{};
  external.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO;
  external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_HOST_ALLOCATION_BIT_EXT;
  VkBufferCreateInfo create{};
  create.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  create.pNext = shares ? &external : nullptr;
  create.size = bytes + (device.guarded ? BufferGuard::kBytes : 0);
  create.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                 VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  if (const VkResult r = vkCreateBuffer(device.handle(), &create, nullptr, &out.buffer_); r != VK_SUCCESS)
    return vulkan_error("vkCreateBuffer", r);

  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(device.handle(), out.buffer_, &needs);
  const VkMemoryPropertyFlags host =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const bool map = (kind != BufferKind::kDevice && kind != BufferKind::kTexels) || device.unified();
  int type = -1;
  if (!map) {
    type = device.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0);
  } else if (kind == BufferKind::kReadback || device.unified()) {
    type = device.memory_type(needs.memoryTypeBits, host, VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  } else {
    type = device.memory_type(needs.memoryTypeBits, host, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  }
  if (type < 0) return Error{ErrorCode::kInternal, device.name() + " has no memory type for " + what};
  VkMemoryAllocateInfo allocate{};
  allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  const std::uint64_t before = device.guarded ? BufferGuard::before(needs.alignment) : 0;
  allocate.allocationSize = before + needs.size;
  allocate.memoryTypeIndex = static_cast<std::uint32_t>(type);
  VkImportMemoryHostPointerInfoEXT import{};
  VkResult allocated = device.injected(GpuFault::Call::kAllocate);
  if (shares && allocated == VK_SUCCESS) {
    const std::uint64_t page = device.page();
    allocate.allocationSize = (allocate.allocationSize + page - 1) / page * page;
    out.pages_ = of != nullptr
                     ? of->pages_
                     : std::shared_ptr<void>(std::aligned_alloc(page, allocate.allocationSize), std::free);
    if (!out.pages_) allocated = VK_ERROR_OUT_OF_HOST_MEMORY;
    import.sType = VK_STRUCTURE_TYPE_IMPORT_MEMORY_HOST_POINTER_INFO_EXT;
    import.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_HOST_ALLOCATION_BIT_EXT;
    import.pHostPointer = out.pages_.get();
    allocate.pNext = &import;
  }
  if (allocated == VK_SUCCESS)
    allocated = vkAllocateMemory(device.handle(), &allocate, nullptr, &out.memory_);
  if (allocated != VK_SUCCESS)
    return Error{ErrorCode::kInternal, std::string(what) + " need " + mebibytes(bytes) + " beside " +
                                           mebibytes(device.allocated) + " in use, which " + device.name() +
                                           " with " + mebibytes(limits.heap) + " of memory could not give (" +
                                           vulkan_error("vkAllocateMemory", allocated).sentence + ")"};
  if (of == nullptr) {
    out.counted_ = bytes;
    const std::uint64_t now = device.allocated += bytes;
    for (std::uint64_t most = device.most_allocated;
         most < now && !device.most_allocated.compare_exchange_weak(most, now);) {
    }
  }
  if (const VkResult r = vkBindBufferMemory(device.handle(), out.buffer_, out.memory_, before);
      r != VK_SUCCESS)
    return vulkan_error("vkBindBufferMemory", r);
  if (device.texels()) {
    VkBufferViewCreateInfo view{};
    view.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
    view.buffer = out.buffer_;
    view.format = kind == BufferKind::kTexels ? VK_FORMAT_R32G32B32A32_UINT : VK_FORMAT_R32_UINT;
    view.range = kind == BufferKind::kTexels ? bytes / 16 * 16 : bytes;
    if (const VkResult r = vkCreateBufferView(device.handle(), &view, nullptr, &out.texels_); r != VK_SUCCESS)
      return vulkan_error("vkCreateBufferView", r);
  }
  if (map)
    if (const VkResult r = vkMapMemory(device.handle(), out.memory_, 0, VK_WHOLE_SIZE, 0, &out.mapped_);
        r != VK_SUCCESS)
      return vulkan_error("vkMapMemory", r);
  if (device.guarded) {
    if (of == nullptr)
      out.guard_ = std::make_unique<BufferGuard>(device, what, out.memory_, out.mapped_, before, bytes);
    if (map) out.mapped_ = static_cast<char*>(out.mapped_) + before;
  }
  return out;
}

VulkanBuffer::~VulkanBuffer() {
  if (device_ == nullptr) return;
  guard_.reset();
  device_->allocated -= counted_;
  vkDestroyBufferView(device_->handle(), texels_, nullptr);
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  vkFreeMemory(device_->handle(), memory_, nullptr);
}

VulkanBuffer::VulkanBuffer(VulkanBuffer&& other) noexcept { *this = std::move(other); }

VulkanBuffer& VulkanBuffer::operator=(VulkanBuffer&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(texels_, other.texels_);
  std::swap(memory_, other.memory_);
  std::swap(kind_, other.kind_);
  std::swap(bytes_, other.bytes_);
  std::swap(counted_, other.counted_);
  std::swap(pages_, other.pages_);
  std::swap(mapped_, other.mapped_);
  std::swap(guard_, other.guard_);
  return *this;
}

bool VulkanBuffer::write(std::uint64_t at, const void* data, std::uint64_t bytes) const {
  assert(at + bytes <= bytes_ && "the host writes beyond a buffer");
  if (mapped_ == nullptr) return false;
  if (bytes != 0) std::memcpy(static_cast<char*>(mapped_) + at, data, bytes);
  return true;
}

Result<void> upload(VulkanDevice& device, const VulkanBuffer& to, const void* data, std::uint64_t bytes) {
  if (bytes == 0) return {};
  if (to.write(0, data, bytes)) return {};
  auto staging = VulkanBuffer::create(device, "staging", bytes, BufferKind::kUpload);
  if (!staging) return staging.error();
  staging->write(0, data, bytes);
  auto recorder = CommandRecorder::create(device);
  if (!recorder) return recorder.error();
  recorder->begin();
  recorder->copy(*staging, 0, to, 0, bytes);
  return recorder->submit_and_wait();
}

Result<void> download(VulkanDevice& device, const VulkanBuffer& buffer, std::uint64_t from, void* data,
                      std::uint64_t bytes) {
  if (bytes == 0) return {};
  if (const char* there = buffer.as<char>()) {
    std::memcpy(data, there + from, bytes);
    return {};
  }
  auto staging = VulkanBuffer::create(device, "staging", bytes, BufferKind::kReadback);
  if (!staging) return staging.error();
  auto recorder = CommandRecorder::create(device);
  if (!recorder) return recorder.error();
  recorder->begin();
  recorder->copy(buffer, from, *staging, 0, bytes);
  if (auto r = recorder->submit_and_wait(); !r) return r;
  std::memcpy(data, staging->as<char>(), bytes);
  return {};
}

}  // namespace palpate
