#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/bytes_of.h"

namespace palpate {

/// Remembers answers that depend on a voxel and on the sides of the planes of what it lists, and on nothing
/// else: such a cell is convex and no listed triangle passes through it. A table of fixed size, where a newer
/// answer takes an older one's place. Only the constructor allocates. Threads may share it: an entry is one
/// word, whole or not there.
class CellMemo {
 public:
  static constexpr std::size_t kMostPlanes = 31;
  static constexpr std::size_t kMostCells = std::size_t{1} << 15;  ///< 256 KiB (chosen)

  CellMemo() = default;
  /// Of a partition with so many V_bnd voxels.
  explicit CellMemo(std::size_t voxels)
      : entries_(std::bit_ceil(voxels < kMostCells ? voxels + 1 : kMostCells)) {}

  /// `voxel`: number of a V_bnd voxel; `sides`: a bit a plane, of at most kMostPlanes.
  std::optional<bool> find(std::uint32_t voxel, std::uint32_t sides) const {
    const std::uint64_t entry = at(voxel, sides).load(std::memory_order_relaxed);
    if (entry >> 1 != key(voxel, sides)) return std::nullopt;
    return (entry & 1) != 0;
  }
  /// find() will soon be asked.
  void prefetch(std::uint32_t voxel, std::uint32_t sides) const {
    __builtin_prefetch(&entries_[place(voxel, sides)]);
  }
  std::uint64_t bytes() const { return bytes_of(entries_); }
  void keep(std::uint32_t voxel, std::uint32_t sides, bool answer) {
    at(voxel, sides).store(key(voxel, sides) << 1 | (answer ? 1u : 0u), std::memory_order_relaxed);
  }

 private:
  std::atomic_ref<std::uint64_t> at(std::uint32_t voxel, std::uint32_t sides) const {
    return std::atomic_ref(entries_[place(voxel, sides)]);
  }
  /// Never 0, which is an empty entry's.
  static std::uint64_t key(std::uint32_t voxel, std::uint32_t sides) {
    return (std::uint64_t{voxel} + 1) << kMostPlanes | sides;
  }
  std::size_t place(std::uint32_t voxel, std::uint32_t sides) const {
    const std::uint64_t mixed = key(voxel, sides) * 0x9E3779B97F4A7C15;  // 2^64 / golden ratio
    return static_cast<std::size_t>(mixed >> 32) & (entries_.size() - 1);
  }
  mutable std::vector<std::uint64_t> entries_;  ///< key, then the answer; their number is a power of two
};

}  // namespace palpate
