#include <random>

#include "compute/gpu/prepare/steps.h"
#include "shaders/code.h"
#include "shaders/shared/scene.h"
#include "tests/compute/brick_floods.h"
#include "tests/compute/gpu_test.h"

namespace palpate {
namespace {

using BrickLabel = GpuTest;
using Voxels = BrickVoxels;

TEST_F(BrickLabel, EqualsADepthFirstSearch) {
  std::vector<Voxels> cases(2);  // all open; and all boundary:
  cases[1].set();
  Voxels chequered, snake;
  for (std::size_t v = 0; v < 512; ++v) {
    const std::size_t x = v & 7, y = v >> 3 & 7, z = v >> 6;
    chequered[v] = (x + y + z) % 2 == 1;
    // One path: along x, over to the next row but one at alternating ends, through every other slice.
    const bool wall = y % 2 == 1 && x != ((y / 2) % 2 == 0 ? 7u : 0u);
    snake[v] = z % 2 == 1 ? !(x == 0 && y == ((z / 2) % 2 == 0 ? 7u : 0u)) : wall;
  }
  cases.push_back(chequered);
  cases.push_back(~chequered);
  cases.push_back(snake);
  std::mt19937 random{5};
  for (unsigned percent = 10; percent < 100; percent += 5)
    for (int i = 0; i < 60; ++i) {
      Voxels v;
      for (std::size_t k = 0; k < 512; ++k) v[k] = random() % 100 < percent;
      cases.push_back(v);
    }

  std::vector<gpu::Brick> bricks(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (std::size_t k = 0; k < 512; ++k)
      if (cases[i][k]) bricks[i].boundary[k >> 5] |= 1u << (k & 31);
  const Progress silent;
  PrepareSteps steps(device(), silent);
  const auto count = static_cast<std::uint32_t>(cases.size());
  const VulkanBuffer in = steps.filled("bricks", bricks),
                     labels = steps.buffer("labels", std::uint64_t{count} * 128),
                     counts = steps.buffer("counts", count);
  steps.fill(labels, 0);
  steps.run_items(spirv::brick_label, {}, {in, labels, counts}, count, count);
  ASSERT_TRUE(steps.ok()) << steps.error().sentence;
  std::vector<std::uint32_t> got(std::size_t{count} * 128), got_count(count);
  ASSERT_TRUE(download(device(), labels, 0, got.data(), got.size() * 4));
  ASSERT_TRUE(download(device(), counts, 0, got_count.data(), got_count.size() * 4));

  for (std::size_t i = 0; i < cases.size(); ++i) {
    int want_count = 0;
    const auto want = components_of(cases[i], want_count);
    ASSERT_EQ(got_count[i], static_cast<std::uint32_t>(want_count)) << "case " << i;
    for (std::size_t k = 0; k < 512; ++k) {
      if (cases[i][k]) continue;
      int label = 0;
      for (std::size_t plane = 0; plane < 8; ++plane)
        label |= static_cast<int>(got[i * 128 + plane * 16 + (k >> 5)] >> (k & 31) & 1u) << plane;
      ASSERT_EQ(label, want[k]) << "case " << i << ", voxel " << k;
    }
  }
}

}  // namespace
}  // namespace palpate
