#include "compute/brick_bits.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace palpate {
namespace {

/// Voxels of a made-up partition: bricks of all three kinds.
struct Voxels {
  Int3 bricks{0};
  std::vector<bool> set, within;   ///< not V_ext; V_int
  BrickBits bits, internal;

  bool at(const Int3& v) const { return set[place(v)]; }
  std::size_t place(const Int3& v) const { return static_cast<std::size_t>(v.x + 8 * bricks.x * (v.y + 8 * bricks.y * v.z)); }
  Voxels(const Int3& size, unsigned seed) : bricks(size), set(512 * static_cast<std::size_t>(size.x * size.y * size.z)), within(set.size()) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> slots;
    std::vector<gpu::Brick> mixed;
    Int3 b;
    for (b.z = 0; b.z < size.z; ++b.z)
      for (b.y = 0; b.y < size.y; ++b.y)
        for (b.x = 0; b.x < size.x; ++b.x) {
          const auto kind = random() % 4;
          slots.push_back(kind == 0 ? gpu::kBrickInternal : kind == 1 ? gpu::kBrickExternal : static_cast<std::uint32_t>(mixed.size()));
          if (kind >= 2) mixed.emplace_back();
          for (std::uint32_t bit = 0; bit < 512; ++bit) {
            bool in = kind == 0, inside = in;
            if (kind >= 2 && random() % 40 == 0) {
              in = true;
              inside = random() % 2 != 0;
              auto& words = inside ? mixed.back().internal_ : mixed.back().boundary;
              words[bit >> 5] |= 1u << (bit & 31);
            }
            const Int3 v = 8 * b + Int3(static_cast<int>(bit & 7), static_cast<int>(bit >> 3 & 7), static_cast<int>(bit >> 6));
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
    const int most = i % 2 == 0 ? 4 : 32;   // half of them within a brick or two
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t end = 8 * voxels.bricks[static_cast<int>(k)];
      range.first[k] = static_cast<std::int32_t>(random() % static_cast<unsigned>(end));
      range.last[k] = std::min(end - 1, range.first[k] + static_cast<std::int32_t>(random() % static_cast<unsigned>(most)));
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
        const bool any = within && voxels.bits.for_bricks({{8 * x, 8 * y, 8 * z}, {8 * x + 7, 8 * y + 7, 8 * z + 7}}, [](int, int, int) { return true; });
        ASSERT_EQ(coarser.at(coarser.number(x >> 3, y >> 3, z >> 3), static_cast<std::uint32_t>((x & 7) | (y & 7) << 3 | (z & 7) << 6)), any);
      }
}

}  // namespace
}  // namespace palpate
