#pragma once
#include <cstdint>
#include <vector>

#include "compute/vulkan_buffer.h"

namespace palpate {

/// What a device buffer holds, for the host to read at any time: the buffer's own memory where it is mapped, else a copy. The buffer
/// outlives this and is not written meanwhile.
template <class T>
class HostCopy {
 public:
  /// `count` entries from the beginning. Allocates.
  Result<void> read(VulkanDevice& device, const VulkanBuffer& buffer, std::size_t count) {
    own_.clear();
    data_ = buffer.as<const T>();
    if (data_ != nullptr || count == 0) return {};
    own_.resize(count);
    data_ = own_.data();
    return download(device, buffer, 0, own_.data(), count * sizeof(T));
  }
  const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::vector<T> own_;
  const T* data_ = nullptr;   // a moved vector keeps its memory
};

}  // namespace palpate
