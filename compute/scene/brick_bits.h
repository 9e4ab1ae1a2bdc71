#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "compute/scene/scene_tables.h"
#include "model/bytes_of.h"
#include "model/lattice/vector.h"

namespace palpate {

/// Bits of a brick between two places along an axis, both among them: along x and y within every plane, along
/// z whole planes.
struct BrickMasks {
  std::uint64_t x[8][8]{}, y[8][8]{};
  std::array<std::uint64_t, 8> z[8][8]{};
  constexpr BrickMasks() {
    for (std::size_t from = 0; from < 8; ++from)
      for (std::size_t to = from; to < 8; ++to)
        for (std::size_t at = from; at <= to; ++at) {
          x[from][to] |= std::uint64_t{0x0101010101010101} << at;
          y[from][to] |= std::uint64_t{0xFF} << 8 * at;
          z[from][to][at] = ~std::uint64_t{0};
        }
  }
};
inline constexpr BrickMasks kBrickMasks;

/// One bit a voxel of a partition: whether it is not V_ext, or whether it is V_int. A brick's 512 bits lie
/// together, and all bricks without a V_bnd voxel share two such blocks, so that every question is one index
/// and one block, with nothing to decide on the way.
class BrickBits {
 public:
  std::uint64_t bytes() const { return bytes_of(block_) + bytes_of(bits_); }

  using Block = std::array<std::uint64_t, 8>;  ///< by z: bit x + 8y

  enum class Of { kOccupied, kInternal };  ///< not V_ext; V_int

  /// Allocates.
  void make(const PartitionView& from, Of of) {
    make(from.grid.bricks, {from.brick_slot.begin(), from.brick_slot.end()}, from.bricks, of);
  }
  /// `size` in bricks; `slots` as brick_slot has them.
  void make(const Int3& size, std::vector<std::uint32_t> slots, std::span<const gpu::Brick> bricks, Of of) {
    std::vector<Block> blocks(bricks.size());
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      const auto half = [&](std::size_t word) {
        return std::uint64_t{bricks[i].internal_[word] |
                             (of == Of::kOccupied ? bricks[i].boundary[word] : 0)};
      };
      for (std::size_t z = 0; z < 8; ++z) blocks[i][z] = half(2 * z) | half(2 * z + 1) << 32;
    }
    make(size, std::move(slots), blocks);
  }
  /// The same of bits that are there: `slots` says which of `blocks`.
  void make(const Int3& size, std::vector<std::uint32_t> slots, std::span<const Block> blocks) {
    size_ = size;
    block_ = std::move(slots);
    for (std::uint32_t& block : block_)
      block = block == gpu::kBrickExternal ? 0 : block == gpu::kBrickInternal ? 1 : block + 2;
    bits_.resize(blocks.size() + 2);
    bits_[0].fill(0);
    bits_[1].fill(~std::uint64_t{0});
    std::copy(blocks.begin(), blocks.end(), bits_.begin() + 2);
  }

  /// A bit for each brick: whether it has a voxel.
  BrickBits coarser() const {
    BrickBits out;
    out.size_ = (size_ + 7) >> 3;
    out.block_.resize(static_cast<std::size_t>(out.size_.x) * static_cast<std::size_t>(out.size_.y) *
                      static_cast<std::size_t>(out.size_.z));
    out.bits_.resize(2);
    for (std::int32_t z = 0; z < size_.z; ++z)
      for (std::int32_t y = 0; y < size_.y; ++y)
        for (std::int32_t x = 0; x < size_.x; ++x) {
          if (block_[number(x, y, z)] == 0) continue;
          std::uint32_t& block = out.block_[out.number(x >> 3, y >> 3, z >> 3)];
          if (block == 0) {
            block = static_cast<std::uint32_t>(out.bits_.size());
            out.bits_.emplace_back();
          }
          out.bits_[block][static_cast<std::size_t>(z & 7)] |= std::uint64_t{1} << ((x & 7) | (y & 7) << 3);
        }
    return out;
  }

  /// Voxels that are in this or have one that is `step` voxels further along an axis, 0 < step < 8. Of what
  /// comes out slot() says nothing.
  BrickBits widened(int axis, std::int32_t step) const {
    BrickBits out;
    out.size_ = size_;
    out.block_.resize(block_.size());
    out.bits_ = {bits_[0], bits_[1]};
    Int3 b;
    for (b.z = 0; b.z < size_.z; ++b.z)
      for (b.y = 0; b.y < size_.y; ++b.y)
        for (b.x = 0; b.x < size_.x; ++b.x) {
          Int3 further = b;
          further[axis] += 1;
          const std::size_t at = number(b.x, b.y, b.z);
          const std::uint32_t own = block_[at], next = further[axis] < size_[axis]
                                                           ? block_[number(further.x, further.y, further.z)]
                                                           : 0;
          out.block_[at] = own;  // none or all
          if (own == 1 || (own == 0 && next == 0)) continue;
          out.block_[at] = static_cast<std::uint32_t>(out.bits_.size());
          out.bits_.push_back(united(bits_[own], bits_[next], axis, static_cast<unsigned>(step)));
        }
    return out;
  }

  /// Voxels first … last of the grid.
  struct Range {
    std::int32_t first[3], last[3];
  };
  /// Calls take(x, y, z) for each brick that has one of these voxels, until it returns true: then so does
  /// this.
  template <class Take>
  bool for_bricks(const Range& range, Take&& take) const {
    const std::int32_t(&first)[3] = range.first, (&last)[3] = range.last;
    const auto from = [&](std::size_t k, std::int32_t brick) {
      return brick == first[k] >> 3 ? first[k] & 7 : 0;
    };
    const auto to = [&](std::size_t k, std::int32_t brick) {
      return brick == last[k] >> 3 ? last[k] & 7 : 7;
    };
    for (std::int32_t z = first[2] >> 3; z <= last[2] >> 3; ++z) {
      const auto low = static_cast<std::size_t>(from(2, z)), high = static_cast<std::size_t>(to(2, z));
      for (std::int32_t y = first[1] >> 3; y <= last[1] >> 3; ++y) {
        const std::uint64_t rows = kBrickMasks.y[from(1, y)][to(1, y)];
        for (std::int32_t x = first[0] >> 3; x <= last[0] >> 3; ++x) {
          const Block& own = bits(number(x, y, z));
          const std::uint64_t found =
              high - low < 2 ? own[low] | own[high] : within(own, kBrickMasks.z[low][high]);
          if ((found & rows & kBrickMasks.x[from(0, x)][to(0, x)]) != 0 && take(x, y, z)) return true;
        }
      }
    }
    return false;
  }

  /// In bricks.
  const Int3& size() const { return size_; }
  /// Number of a brick within the grid.
  std::size_t number(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return static_cast<std::size_t>(x) +
           static_cast<std::size_t>(size_.x) *
               (static_cast<std::size_t>(y) +
                static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(z));
  }
  /// The bits of the brick of this number.
  const Block& bits(std::size_t brick) const { return bits_[block_[brick]]; }
  /// Which mixed brick it is, or kBrickInternal or kBrickExternal.
  std::uint32_t slot(std::size_t brick) const {
    const std::uint32_t block = block_[brick];
    return block == 0 ? gpu::kBrickExternal : block == 1 ? gpu::kBrickInternal : block - 2;
  }
  /// Bit x + 8y + 64z of a brick.
  bool at(std::size_t brick, std::uint32_t bit) const {
    return (bits(brick)[bit >> 6] >> (bit & 63) & 1) != 0;
  }

 private:
  /// A brick's bits with those `step` further along an axis, where `next` is the next brick.
  static Block united(const Block& own, const Block& next, int axis, unsigned step) {
    const std::uint64_t low =
        0x0101010101010101u * (0xFFu >> step);  // of a row, those that come from the same brick
    Block out;
    for (unsigned z = 0; z < 8; ++z)
      out[z] = own[z] | (axis == 0      ? (own[z] >> step & low) | (next[z] << (8 - step) & ~low)
                         : axis == 1    ? own[z] >> 8 * step | next[z] << (64 - 8 * step)
                         : z + step < 8 ? own[z + step]
                                        : next[z + step - 8]);
    return out;
  }
  /// What some planes of a brick have, one upon the other. All planes at once: a loop over several would be
  /// mispredicted each time.
  static std::uint64_t within(const Block& own, const Block& planes) {
    using Two = std::uint64_t __attribute__((vector_size(16)));
    Two found{};
    for (std::size_t k = 0; k < 8; k += 2) {
      Two a, b;
      std::memcpy(&a, &own[k], sizeof a);
      std::memcpy(&b, &planes[k], sizeof b);
      found |= a & b;
    }
    return found[0] | found[1];
  }

  Int3 size_{0};
  std::vector<std::uint32_t> block_;  ///< by brick: 0 none, 1 all, else its own
  std::vector<Block> bits_;
};

}  // namespace palpate
