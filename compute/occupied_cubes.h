#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "compute/brick_bits.h"
#include "compute/turned_boxes.h"

namespace palpate {

/// A first look at small boxes: for cubes of 1, 2, 4 and 8 voxels, from every voxel of the mock-up's grid on, whether one of theirs is not V_ext. Most
/// boxes near a mock-up meet nothing; one bit says so, where going through a box's voxels takes loops whose ends can't be foreseen.
class OccupiedCubes {
 public:
  /// Allocates: what the bricks near occupied voxels take, four times.
  void make(const BrickBits& occupied) {
    levels_[0] = occupied;
    for (std::size_t level = 1; level < kLevels; ++level) {
      levels_[level] = levels_[level - 1];
      for (int axis = 0; axis < 3; ++axis) levels_[level] = levels_[level].widened(axis, std::int32_t{1} << (level - 1));
    }
  }

  /// Of eight ranges those that may have an occupied voxel, a bit each: whose smallest such cube from their first voxel on has one, or which fit into
  /// none.
  unsigned near(const EightRanges& voxels) const {
    std::array<std::uint32_t, kEight> level, brick, bit, large;
    const Int3& size = levels_[0].size();
    for (std::size_t i = 0; i < kEight; ++i) {
      const std::int32_t x = voxels.first[0][i], y = voxels.first[1][i], z = voxels.first[2][i];
      const std::int32_t beyond = std::max({voxels.last[0][i] - x, voxels.last[1][i] - y, voxels.last[2][i] - z});
      level[i] = static_cast<std::uint32_t>((beyond > 0) + (beyond > 1) + (beyond > 3));
      large[i] = beyond > 7;
      brick[i] = static_cast<std::uint32_t>((x >> 3) + size.x * ((y >> 3) + size.y * (z >> 3)));
      bit[i] = static_cast<std::uint32_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6);
    }
    unsigned out = 0;
    for (std::size_t i = 0; i < kEight; ++i) {
      const auto may = static_cast<unsigned>(voxels.may[i]) & 1;
      out |= ((levels_[level[i]].at(brick[i], bit[i]) ? 1u : 0u) | large[i]) << i & may << i;
    }
    return out;
  }

 private:
  static constexpr std::size_t kLevels = 4;
  std::array<BrickBits, kLevels> levels_;
};

}  // namespace palpate
