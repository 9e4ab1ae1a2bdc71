#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/native/prepare/scene.h"
#include "compute/scene/partition.h"

namespace palpate {

/// Two partitions hold the same numbers in the same places.
inline void expect_equal(const Partition& a, const Partition& b, const std::string& body) {
  EXPECT_EQ(std::memcmp(&a.grid, &b.grid, sizeof a.grid), 0) << body;
  EXPECT_EQ(a.has_internal, b.has_internal) << body;
  EXPECT_TRUE(a.brick_slot == b.brick_slot) << body;
  EXPECT_TRUE(a.mixed_brick == b.mixed_brick) << body;
  EXPECT_TRUE(a.boundary_place == b.boundary_place) << body;
  EXPECT_TRUE(a.list_begin == b.list_begin) << body;
  EXPECT_TRUE(a.list_triangles == b.list_triangles) << body;
  ASSERT_EQ(a.bricks.size(), b.bricks.size()) << body;
  for (std::size_t i = 0; i < a.bricks.size(); ++i)
    for (std::size_t word = 0; word < 16; ++word) {
      ASSERT_EQ(a.bricks[i].boundary[word], b.bricks[i].boundary[word])
          << body << ", brick " << i << ", word " << word;
      ASSERT_EQ(a.bricks[i].internal_[word], b.bricks[i].internal_[word])
          << body << ", brick " << i << ", word " << word;
      ASSERT_EQ(a.bricks[i].first[word], b.bricks[i].first[word])
          << body << ", brick " << i << ", word " << word;
    }
}

/// What both engines have made of a scene beside the partitions of its bodies.
inline void expect_equal_tables(VulkanDevice& device, const PreparedScene& gpu, const native::Scene& native) {
  EXPECT_EQ(std::memcmp(&gpu.constants, &native.constants, sizeof gpu.constants), 0);
  EXPECT_EQ(static_cast<bool>(gpu.fine.brick_slot), !native.fine.brick_slot.empty());
  if (gpu.fine.brick_slot) {
    const auto fine = read_partition(device, gpu.fine);
    ASSERT_TRUE(fine) << fine.error().sentence;
    expect_equal(*fine, native.fine, "tool in finer voxels");
  }
  const auto words = [&](const VulkanBuffer& buffer, std::size_t count) {
    std::vector<std::uint32_t> out(buffer ? count : 0);
    EXPECT_TRUE(out.empty() || download(device, buffer, 0, out.data(), 4 * out.size()));
    return out;
  };
  EXPECT_TRUE(words(gpu.fine_exit, native.fine_exit.size()) == native.fine_exit);
  EXPECT_TRUE(words(gpu.tool_near, native.tool_near.size()) == native.tool_near);
  EXPECT_EQ(static_cast<bool>(gpu.sample_points), native.samples && native.samples->listed());
}

}  // namespace palpate
