#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "compute/vulkan/buffer.h"

namespace palpate {

/// What a device buffer holds, for the host to read at any time: the buffer's own memory where it is mapped,
/// else a copy, one for all who ask while somebody has it. The buffer outlives this and is not written
/// meanwhile.
template <class T>
class HostCopy {
  static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(std::uint64_t));

 public:
  /// `count` entries from the beginning. Allocates.
  Result<void> read(VulkanDevice& device, const VulkanBuffer& buffer, std::size_t count) {
    copy_.reset();
    count_ = count;
    data_ = buffer.as<T>();
    if (data_ != nullptr || count == 0) return {};
    auto& known = device.host_copies[buffer.handle()];
    const std::size_t words = (count * sizeof(T) + 7) / 8;
    copy_ = known.lock();
    if (!copy_ || copy_->size() < words) {
      copy_ = std::make_shared<std::vector<std::uint64_t>>(words);
      if (auto r = download(device, buffer, 0, copy_->data(), count * sizeof(T)); !r) return r;
      known = copy_;
    }
    data_ = reinterpret_cast<const T*>(copy_->data());
    return {};
  }
  std::span<const T> all() const { return {data_, count_}; }

 private:
  std::shared_ptr<std::vector<std::uint64_t>> copy_;
  const T* data_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace palpate
