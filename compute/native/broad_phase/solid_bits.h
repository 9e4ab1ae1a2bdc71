#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "compute/scene/brick_bits.h"
#include "model/bytes_of.h"

namespace palpate {

/// Cubes that may hold a point inside a solid, and those that hold nothing else: a bit each. Those of a brick
/// lie beside each other, for who has asked about the one mostly asks about the other next.
class SolidBits {
 public:
  struct Block {
    BrickBits::Block may, all;  ///< bit x + 8y + 64z
    bool may_at(std::uint32_t bit) const { return (may[bit >> 6] >> (bit & 63) & 1) != 0; }
    bool all_at(std::uint32_t bit) const { return (all[bit >> 6] >> (bit & 63) & 1) != 0; }
  };

  SolidBits() = default;
  /// Both of the same size. Allocates.
  SolidBits(const BrickBits& may, const BrickBits& all) : size_(may.size()) {
    const auto bricks = static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                        static_cast<std::size_t>(size_.z);
    std::unordered_map<std::uint64_t, std::uint32_t> known;  // by both's slots
    number_.reserve(bricks);
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      const std::uint64_t slots = std::uint64_t{may.slot(brick)} << 32 | all.slot(brick);
      const auto [at, is_new] = known.emplace(slots, static_cast<std::uint32_t>(blocks_.size()));
      if (is_new) blocks_.push_back({may.bits(brick), all.bits(brick)});
      number_.push_back(at->second);
    }
  }

  /// In bricks.
  const Int3& size() const { return size_; }
  /// Of the brick x + size.x · (y + size.y · z): which block it has.
  std::uint32_t number(std::size_t brick) const { return number_[brick]; }
  const Block& block(std::uint32_t number) const { return blocks_[number]; }
  std::uint64_t bytes() const { return bytes_of(number_) + bytes_of(blocks_); }

 private:
  Int3 size_{0};
  std::vector<std::uint32_t> number_;
  std::vector<Block> blocks_;
};

}  // namespace palpate
