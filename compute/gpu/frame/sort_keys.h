#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// Sorts numbers whose lower 32 bits ascend: by the upper ones, digit by digit, which a frame's lists of ids
/// (a few thousand, below a few million) take less time for than to be compared. `spare` is room; allocates
/// only when it is smaller than `keys`.
inline void sort_keys(std::vector<std::uint64_t>& keys, std::vector<std::uint64_t>& spare) {
  constexpr std::size_t kDigits = 4, kFew = 48;  // chosen: fewer are sorted sooner by comparing
  if (keys.size() < kFew) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  std::array<std::array<std::uint32_t, 256>, kDigits>
      places{};  // first how many there are of a digit, then where its next one goes
  for (const std::uint64_t key : keys)
    for (std::size_t d = 0; d < kDigits; ++d) ++places[d][key >> (32 + 8 * d) & 255];
  spare.resize(keys.size());
  for (std::size_t d = 0; d < kDigits; ++d) {
    if (places[d][keys[0] >> (32 + 8 * d) & 255] == keys.size()) continue;  // all have the same
    std::uint32_t next = 0;
    for (std::uint32_t& place : places[d]) {
      const std::uint32_t count = place;
      place = next;
      next += count;
    }
    for (const std::uint64_t key : keys) spare[places[d][key >> (32 + 8 * d) & 255]++] = key;
    keys.swap(spare);
  }
}

}  // namespace palpate
