// Embree's candidates must hold every box that counts: compared with asking all.
#include "cpu_ref/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cpu_ref/triangle_cube.h"

namespace palpate::cpu_ref {
namespace {

std::vector<Box> random_boxes(std::mt19937& random, std::size_t count, int reach, int side) {
  std::uniform_int_distribution<int> place(-reach, reach - side), size(0, side);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    box.min = Int3(place(random), place(random), place(random));
    box.max = box.min + Int3(size(random), size(random), size(random));
  }
  return boxes;
}

TEST(BoxTree, FindsAllPairsThatMeet) {
  std::mt19937 random(1);
  for (const auto& [count_a, count_b] : {std::pair{2000, 300}, {1, 1}, {1, 500}, {700, 2}, {0, 5}}) {
    const auto a = random_boxes(random, static_cast<std::size_t>(count_a), kLatticeReach, 1 << 24);
    const auto b = random_boxes(random, static_cast<std::size_t>(count_b), kLatticeReach, 1 << 26);
    BoxTree tree_a, tree_b;
    tree_a.build(a);
    tree_b.build(b);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found, expected;
    BoxTree::meeting_pairs(tree_a, tree_b, found);
    for (std::uint32_t i = 0; i < a.size(); ++i)
      for (std::uint32_t j = 0; j < b.size(); ++j)
        if (a[i].meets(b[j])) expected.emplace_back(i, j);
    EXPECT_EQ(found, expected);
  }
}

TEST(BoxTree, BoxesThatTouchAtTheLatticesReachAreAPair) {
  // Steps of one at 2^28 are far below single precision.
  BoxTree a, b;
  a.build({Box{Int3(kLatticeReach - 101), Int3(kLatticeReach - 51)}});
  b.build({Box{Int3(kLatticeReach - 51), Int3(kLatticeReach)},
           Box{Int3(kLatticeReach - 50), Int3(kLatticeReach)}});
  std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
  BoxTree::meeting_pairs(a, b, found);
  EXPECT_EQ(found, (std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 0}}));
}

TEST(BoxTree, RaysFindEveryBoxTheyPass) {
  std::mt19937 random(2);
  const auto boxes = random_boxes(random, 3000, kLatticeReach, 1 << 25);
  BoxTree tree;
  tree.build(boxes);
  std::uniform_int_distribution<int> draw(-kLatticeReach, kLatticeReach), pick(0, 2999), thousand(0, 1000);
  for (int i = 0; i < 300; ++i) {
    // From anywhere to a point of a box, often its corner: at least that box must be found.
    const auto target = static_cast<std::size_t>(pick(random));
    Int3 to;
    for (int k = 0; k < 3; ++k) {
      const std::int64_t side = boxes[target].max[k] - boxes[target].min[k];
      to[k] = boxes[target].min[k] +
              static_cast<int>(side * (i % 2 ? thousand(random) : 1000 * (thousand(random) % 2)) / 1000);
    }
    Int3 from(draw(random), draw(random), draw(random));
    if (i % 5 == 0) from = Int3(from.x, to.y, to.z);  // along an axis
    if (from == to) continue;
    std::vector<std::uint32_t> found;
    tree.along_ray(from, to - from, found);
    std::sort(found.begin(), found.end());
    for (std::uint32_t b = 0; b < boxes.size(); ++b)
      if (segment_meets_box(from, to, boxes[b])) {
        ASSERT_TRUE(std::binary_search(found.begin(), found.end(), b)) << i;
      }
    ASSERT_LT(found.size(), boxes.size() / 4);  // and yet most boxes are left out
  }
}

TEST(BoxTree, FindsAllThatMeetABox) {
  std::mt19937 random(4);
  const auto boxes = random_boxes(random, 3000, kLatticeReach, 1 << 25);
  BoxTree tree;
  tree.build(boxes);
  for (const Box& box : random_boxes(random, 100, kLatticeReach, 1 << 27)) {
    std::vector<std::uint32_t> found, expected;
    tree.meeting(box, found);
    for (std::uint32_t b = 0; b < boxes.size(); ++b)
      if (boxes[b].meets(box)) expected.push_back(b);
    ASSERT_EQ(found, expected);
  }
}

TEST(BoxTree, EmptyBoxesAreNeverFoundAndRebuildingReplaces) {
  BoxTree tree;
  tree.build({Box(), Box{Int3(0), Int3(10)}, Box()});
  std::vector<std::uint32_t> found;
  tree.meeting(Box{Int3(-100), Int3(100)}, found);
  EXPECT_EQ(found, std::vector<std::uint32_t>{1});
  tree.build({Box{Int3(1000000), Int3(1000010)}});
  found.clear();
  tree.meeting(Box{Int3(-100), Int3(100)}, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace palpate::cpu_ref
