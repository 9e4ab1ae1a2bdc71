#include "compute/scene/brick_bits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <random>
#include <set>
#include <tuple>
#include <vector>

#include "compute/native/broad_phase/turned_boxes.h"
#include "compute/scene/occupied_cubes.h"

namespace palpate {
namespace {

/// Voxels of a made-up partition: bricks of all three kinds.
struct Voxels {
  Int3 bricks{0};
  std::vector<bool> set, within;  ///< not V_ext; V_int
  BrickBits bits, internal;

  bool at(const Int3& v) const { return set[place(v)]; }
  std::size_t place(const Int3& v) const {
    return static_cast<std::size_t>(v.x + 8 * bricks.x * (v.y + 8 * bricks.y * v.z));
  }
  Voxels(const Int3& size, unsigned seed)
      : bricks(size), set(512 * static_cast<std::size_t>(size.x * size.y * size.z)), within(set.size()) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> slots;
    std::vector<gpu::Brick> mixed;
    Int3 b;
    for (b.z = 0; b.z < size.z; ++b.z)
      for (b.y = 0; b.y < size.y; ++b.y)
        for (b.x = 0; b.x < size.x; ++b.x) {
          const auto kind = random() % 4;
          slots.push_back(kind == 0   ? gpu::kBrickInternal
                          : kind == 1 ? gpu::kBrickExternal
                                      : static_cast<std::uint32_t>(mixed.size()));
          if (kind >= 2) mixed.emplace_back();
          for (std::uint32_t bit = 0; bit < 512; ++bit) {
            bool in = kind == 0, inside = in;
            if (kind >= 2 && random() % 40 == 0) {
              in = true;
              inside = random() % 2 != 0;
              auto& words = inside ? mixed.back().internal_ : mixed.back().boundary;
              words[bit >> 5] |= 1u << (bit & 31);
            }
            const Int3 v = 8 * b + Int3(static_cast<int>(bit & 7), static_cast<int>(bit >> 3 & 7),
                                        static_cast<int>(bit >> 6));
            set[place(v)] = in;
            within[place(v)] = inside;
          }
        }
    bits.make(size, slots, mixed, BrickBits::Of::kOccupied);
    internal.make(size, slots, mixed, BrickBits::Of::kInternal);
    b = Int3(0);
    for (std::size_t i = 0; i < slots.size(); ++i) EXPECT_EQ(bits.slot(i), slots[i]);
  }
};

TEST(BrickBits, KnowsEveryVoxel) {
  const Voxels voxels({3, 2, 4}, 1);
  Int3 v;
  for (v.z = 0; v.z < 32; ++v.z)
    for (v.y = 0; v.y < 16; ++v.y)
      for (v.x = 0; v.x < 24; ++v.x) {
        const std::size_t brick = voxels.bits.number(v.x >> 3, v.y >> 3, v.z >> 3);
        const auto bit = static_cast<std::uint32_t>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
        ASSERT_EQ(voxels.bits.at(brick, bit), voxels.at(v));
        ASSERT_EQ(voxels.internal.at(brick, bit), voxels.within[voxels.place(v)]);
      }
}

TEST(BrickBits, FindsTheBricksOfEveryRange) {
  const Voxels voxels({4, 3, 2}, 2);
  std::mt19937 random(3);
  std::size_t none = 0;
  for (int i = 0; i < 20'000; ++i) {
    BrickBits::Range range{};
    const int most = i % 2 == 0 ? 4 : 32;  // half of them within a brick or two
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t end = 8 * voxels.bricks[static_cast<int>(k)];
      range.first[k] = static_cast<std::int32_t>(random() % static_cast<unsigned>(end));
      range.last[k] = std::min(
          end - 1, range.first[k] + static_cast<std::int32_t>(random() % static_cast<unsigned>(most)));
    }
    std::set<std::tuple<int, int, int>> expected, found;
    Int3 v;
    for (v.z = range.first[2]; v.z <= range.last[2]; ++v.z)
      for (v.y = range.first[1]; v.y <= range.last[1]; ++v.y)
        for (v.x = range.first[0]; v.x <= range.last[0]; ++v.x)
          if (voxels.at(v)) expected.insert({v.x >> 3, v.y >> 3, v.z >> 3});
    const bool ended = voxels.bits.for_bricks(range, [&](int x, int y, int z) {
      EXPECT_TRUE(found.insert({x, y, z}).second);
      return false;
    });
    ASSERT_FALSE(ended);
    ASSERT_EQ(found, expected);
    int calls = 0;
    ASSERT_EQ(voxels.bits.for_bricks(range, [&](int, int, int) { return ++calls == 1; }), !expected.empty());
    ASSERT_EQ(calls, expected.empty() ? 0 : 1);
    none += expected.empty() ? 1u : 0u;
  }
  EXPECT_GT(none, 1'000u);
  EXPECT_LT(none, 19'000u);
}

TEST(BrickBits, TheCoarserLevelHasABitForEachBrickWithAVoxel) {
  const Voxels voxels({11, 9, 8}, 4);
  const BrickBits coarser = voxels.bits.coarser();
  EXPECT_EQ(coarser.size(), Int3(2, 2, 1));
  for (std::int32_t z = 0; z < 8; ++z)
    for (std::int32_t y = 0; y < 16; ++y)
      for (std::int32_t x = 0; x < 16; ++x) {
        const bool within = x < 11 && y < 9;
        const bool any =
            within && voxels.bits.for_bricks({{8 * x, 8 * y, 8 * z}, {8 * x + 7, 8 * y + 7, 8 * z + 7}},
                                             [](int, int, int) { return true; });
        ASSERT_EQ(coarser.at(coarser.number(x >> 3, y >> 3, z >> 3),
                             static_cast<std::uint32_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6)),
                  any);
      }
}

/// The answer is that of the smallest cube of 1, 2, 4 or 8 voxels that holds the range, voxel by voxel;
/// beyond the grid there is nothing.
TEST(OccupiedCubes, AnswerForTheSmallestCubeFromTheFirstVoxelOn) {
  const Voxels voxels({4, 3, 2}, 5);
  OccupiedCubes cubes;
  cubes.make(voxels.bits);
  const Int3 end = 8 * voxels.bricks;
  std::mt19937 random(6);
  std::array<std::size_t, 5> yes{}, no{};  // by cube
  for (int round = 0; round < 4'000; ++round) {
    EightRanges ranges{};
    unsigned expected = 0;
    for (std::size_t i = 0; i < kEight; ++i) {
      Int3 first, last;
      const unsigned most = 1u << random() % 5;
      for (int k = 0; k < 3; ++k) {
        first[k] = static_cast<std::int32_t>(random() % static_cast<unsigned>(end[k]));
        last[k] = std::min(end[k] - 1, first[k] + static_cast<std::int32_t>(random() % most));
        ranges.first[k][i] = first[k];
        ranges.last[k][i] = last[k];
      }
      ranges.may[i] = random() % 8 != 0 ? -1 : 0;
      const Int3 beyond = last - first;
      const int longest = std::max({beyond.x, beyond.y, beyond.z});
      const std::size_t level = longest == 0 ? 0 : longest < 2 ? 1 : longest < 4 ? 2 : longest < 8 ? 3 : 4;
      bool any = level == 4;
      const Int3 to = glm::min(first + (1 << level), end);
      for (Int3 v = first; v.z < to.z; ++v.z)
        for (v.y = first.y; v.y < to.y; ++v.y)
          for (v.x = first.x; v.x < to.x; ++v.x) any = any || voxels.at(v);
      if (ranges.may[i] == 0) continue;
      ++(any ? yes : no)[level];
      expected |= any ? 1u << i : 0u;
    }
    ASSERT_EQ(cubes.near(ranges), expected) << "round " << round;
  }
  for (std::size_t level = 0; level < 4; ++level) EXPECT_GT(yes[level], 300u) << level;
  for (std::size_t level = 0; level < 3; ++level)
    EXPECT_GT(no[level], 300u) << level;  // in cubes of 8 there is nearly always something
}

}  // namespace
}  // namespace palpate
