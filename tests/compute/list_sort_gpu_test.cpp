#include <algorithm>
#include <random>

#include "compute/gpu/prepare/partition.h"
#include "tests/compute/gpu_test.h"

namespace palpate {
namespace {

using ListSort = GpuTest;

TEST_F(ListSort, SortsListsOfEveryLengthFromAnyOrder) {
  std::mt19937 random{11};
  std::vector<std::uint32_t> begin{0}, lists, entry_voxel, want;
  for (const std::uint32_t length :
       {1u, 2u, 255u, 256u, 257u, 511u, 512u, 513u, 1u, 3000u, 768u, 1025u, 5u}) {
    std::vector<std::uint32_t> ids(length);
    std::uint32_t id = 0;
    for (auto& i : ids) i = id += 1 + static_cast<std::uint32_t>(random() % 3);
    want.insert(want.end(), ids.begin(), ids.end());
    std::shuffle(ids.begin(), ids.end(), random);
    lists.insert(lists.end(), ids.begin(), ids.end());
    entry_voxel.insert(entry_voxel.end(), length, static_cast<std::uint32_t>(begin.size() - 1));
    begin.push_back(static_cast<std::uint32_t>(lists.size()));
  }
  const Progress silent;
  PrepareSteps steps(device(), silent);
  const VulkanBuffer voxels = steps.filled("voxels", entry_voxel), begins = steps.filled("begins", begin);
  VulkanBuffer buffer = steps.filled("lists", lists);
  EXPECT_EQ(sort_lists(steps, voxels, begins, buffer, static_cast<std::uint32_t>(lists.size())), 3000u);
  ASSERT_TRUE(steps.ok()) << steps.error().sentence;
  std::vector<std::uint32_t> got(lists.size());
  ASSERT_TRUE(download(device(), buffer, 0, got.data(), got.size() * 4));
  EXPECT_EQ(got, want);
}

TEST_F(ListSort, PrefixSumsOfAnyLengthEndWithTheTotal) {
  const Progress silent;
  PrepareSteps steps(device(), silent);
  std::mt19937 random{12};
  for (const std::size_t count : {1u, 63u, 64u, 65u, 4095u, 4096u, 300000u}) {
    std::vector<std::uint32_t> values(count + 1), want(count + 1);
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = static_cast<std::uint32_t>(random() % 10);
      want[i] = sum;
      sum += values[i];
    }
    want[count] = sum;
    const VulkanBuffer buffer = steps.filled("values", values);
    EXPECT_EQ(steps.scan("values", buffer, count), sum);
    ASSERT_TRUE(steps.ok()) << steps.error().sentence;
    std::vector<std::uint32_t> got(count + 1);
    ASSERT_TRUE(download(device(), buffer, 0, got.data(), got.size() * 4));
    EXPECT_EQ(got, want) << count;
  }
}

TEST_F(ListSort, ATotalBeyond32BitsIsRefused) {
  const Progress silent;
  PrepareSteps steps(device(), silent);
  const VulkanBuffer buffer = steps.filled("values", std::vector<std::uint32_t>(1001, 1u << 23));
  EXPECT_EQ(steps.scan("pairs", buffer, 1000), 0u);
  ASSERT_FALSE(steps.ok());
  EXPECT_NE(steps.error().sentence.find("more than 4294967294 pairs"), std::string::npos)
      << steps.error().sentence;
}

}  // namespace
}  // namespace palpate
