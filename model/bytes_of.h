#pragma once
#include <cstdint>
#include <vector>

namespace palpate {

/// What a vector has taken of memory, room for more with it.
template <class T>
std::uint64_t bytes_of(const std::vector<T>& items) {
  return sizeof(T) * std::uint64_t{items.capacity()};
}

}  // namespace palpate
