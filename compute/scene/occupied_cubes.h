#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <vector>

#include "compute/scene/brick_bits.h"
#include "model/bytes_of.h"

namespace palpate {

/// A first look at small boxes: for cubes of 1, 2, 4 and 8 voxels, from every voxel of the mock-up's grid on,
/// whether one of theirs is not V_ext. Most boxes near a mock-up meet nothing; one bit says so, where going
/// through a box's voxels takes loops whose ends can't be foreseen. Shaders read the same
/// (shaders/lib/broad_phase/occupied.glsl).
class OccupiedCubes {
 public:
  std::uint64_t bytes() const { return bytes_of(place_) + bytes_of(cubes_); }
  /// `occupied`: voxels that are not V_ext. Allocates four bytes a brick, and 256 for each that is not V_int
  /// but has an occupied voxel, or has one in the next bricks along the axes.
  void make(const BrickBits& occupied) {
    size_ = occupied.size();
    place_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                      static_cast<std::size_t>(size_.z),
                  0);
    cubes_.assign(2, Cubes{});
    for (BrickBits::Block& level : cubes_[kAll]) level.fill(~std::uint64_t{0});
    Int3 b;  // cubes from a brick's voxels on reach into the next one along each axis
    for (b.z = 0; b.z < size_.z; ++b.z)
      for (b.y = 0; b.y < size_.y; ++b.y)
        for (b.x = 0; b.x < size_.x; ++b.x) {
          std::uint32_t& place = place_[occupied.number(b.x, b.y, b.z)];
          if (occupied.slot(occupied.number(b.x, b.y, b.z)) == gpu::kBrickInternal) {
            place = kAll;
            continue;
          }
          const Int3 last = glm::min(8 * b + 15, 8 * size_ - 1);
          if (!occupied.for_bricks({{8 * b.x, 8 * b.y, 8 * b.z}, {last.x, last.y, last.z}},
                                   [](int, int, int) { return true; }))
            continue;
          place = static_cast<std::uint32_t>(cubes_.size());
          cubes_.emplace_back();
        }
    BrickBits grown = occupied;
    for (std::size_t level = 0; level < kLevels; ++level) {
      if (level > 0)
        for (int axis = 0; axis < 3; ++axis) grown = grown.widened(axis, std::int32_t{1} << (level - 1));
      for (std::size_t brick = 0; brick < place_.size(); ++brick)
        if (place_[brick] > kAll) cubes_[place_[brick]][level] = grown.bits(brick);
    }
  }

  /// Of eight ranges those that may have an occupied voxel, a bit each: whose smallest such cube from their
  /// first voxel on has one, or which fit into none. `voxels` as voxels_of() leaves them (EightRanges of
  /// compute/native/broad_phase/turned_boxes.h): within the grid, also where they may not.
  template <class EightRanges>
  unsigned near(const EightRanges& voxels) const {
    constexpr std::size_t kRanges = 8;
    std::array<std::uint32_t, kRanges> level, brick, bit, large;
    for (std::size_t i = 0; i < kRanges; ++i) {
      const std::int32_t x = voxels.first[0][i], y = voxels.first[1][i], z = voxels.first[2][i];
      const std::int32_t beyond =
          std::max({voxels.last[0][i] - x, voxels.last[1][i] - y, voxels.last[2][i] - z});
      level[i] = static_cast<std::uint32_t>((beyond > 0) + (beyond > 1) + (beyond > 3));
      large[i] = beyond > 7;
      brick[i] = static_cast<std::uint32_t>((x >> 3) + size_.x * ((y >> 3) + size_.y * (z >> 3)));
      bit[i] = static_cast<std::uint32_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6);
    }
    unsigned out = 0;
    for (std::size_t i = 0; i < kRanges; ++i) {
      const std::uint64_t plane = cubes_[place_[brick[i]]][level[i]][bit[i] >> 6];
      const auto may = static_cast<unsigned>(voxels.may[i]) & 1;
      out |= ((static_cast<unsigned>(plane >> (bit[i] & 63)) & 1) | large[i]) << i & may << i;
    }
    return out;
  }

  static constexpr std::size_t kLevels = 4;
  using Cubes =
      std::array<BrickBits::Block, kLevels>;  ///< of a brick: a bit for each voxel that such a cube begins at
  /// By brick, in cubes(): 0 none is occupied, nor in the next bricks; 1 all are.
  const std::vector<std::uint32_t>& places() const { return place_; }
  const std::vector<Cubes>& cubes() const { return cubes_; }

 private:
  static constexpr std::uint32_t kAll =
      1;  // a place: all voxels are occupied; 0: none, nor in the next bricks

  Int3 size_{0};                      ///< bricks
  std::vector<std::uint32_t> place_;  ///< by brick, in `cubes_`
  std::vector<Cubes> cubes_;
};

}  // namespace palpate
