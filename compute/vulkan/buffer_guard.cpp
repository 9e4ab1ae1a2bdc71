#include "compute/vulkan/buffer_guard.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "compute/vulkan/buffer.h"
#include "compute/vulkan/command_recorder.h"
#include "compute/vulkan/device.h"

namespace palpate {
namespace {
constexpr std::uint8_t kCanary = 0xA5;
constexpr std::uint32_t kCanaryWord = 0xA5A5A5A5u;
}  // namespace

BufferGuard::BufferGuard(VulkanDevice& device, std::string what, VkDeviceMemory memory, void* mapped,
                         std::uint64_t before, std::uint64_t bytes)
    : device_(device),
      what_(std::move(what)),
      memory_(memory),
      mapped_(static_cast<std::uint8_t*>(mapped)),
      before_(before),
      bytes_(bytes) {
  const std::uint64_t all = before_ + bytes_ + kBytes;
  std::string error;
  if (mapped_ != nullptr) {
    std::memset(mapped_, kCanary, all);
  } else {
    VkBufferCreateInfo create{};
    create.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    create.size = all;
    create.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    create.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    if (vkCreateBuffer(device_.handle(), &create, nullptr, &whole_) != VK_SUCCESS ||
        vkBindBufferMemory(device_.handle(), whole_, memory_, 0) != VK_SUCCESS) {
      error = what_ + ": no guard could be made";
    } else if (auto recorder = CommandRecorder::create(device_)) {
      recorder->begin();
      recorder->fill(whole_, kCanaryWord, 0, all / 4 * 4);
      if (auto r = recorder->submit_and_wait(); !r) error = r.error().sentence;
    }
  }
  const std::lock_guard lock(device_.guard_mutex);
  device_.guards.insert(this);
  if (device_.guard_error.empty()) device_.guard_error = std::move(error);
}

BufferGuard::~BufferGuard() {
  std::string error = broken().value_or("");
  {
    const std::lock_guard lock(device_.guard_mutex);
    device_.guards.erase(this);
    if (device_.guard_error.empty()) device_.guard_error = std::move(error);
  }
  vkDestroyBuffer(device_.handle(), whole_, nullptr);
}

bool BufferGuard::read(std::uint64_t from, std::vector<std::uint8_t>& bytes) {
  if (mapped_ != nullptr) {
    std::memcpy(bytes.data(), mapped_ + from, bytes.size());
    return true;
  }
  auto staging = VulkanBuffer::create(device_, "guard bytes", bytes.size(), BufferKind::kReadback);
  auto recorder = CommandRecorder::create(device_);
  if (!staging || !recorder) return false;
  recorder->begin();
  recorder->copy(whole_, from, staging->handle(), 0, bytes.size());
  if (!recorder->submit_and_wait()) return false;
  std::memcpy(bytes.data(), staging->as<char>(), bytes.size());
  return true;
}

std::optional<std::string> BufferGuard::broken() {
  for (const bool behind : {false, true}) {
    std::vector<std::uint8_t> bytes(behind ? kBytes : before_);
    if (!read(behind ? before_ + bytes_ : 0, bytes)) return what_ + ": the guard bytes could not be read";
    const auto wrong = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t b) { return b != kCanary; });
    if (wrong == bytes.end()) continue;
    const auto at = static_cast<std::uint64_t>(wrong - bytes.begin());
    return what_ + " (" + std::to_string(bytes_) + " bytes): something wrote " +
           (behind ? std::to_string(at) + " bytes behind its end"
                   : std::to_string(before_ - at) + " bytes before its start");
  }
  return std::nullopt;
}

}  // namespace palpate
