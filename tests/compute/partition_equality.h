#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <string>

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
      ASSERT_EQ(a.bricks[i].boundary[word], b.bricks[i].boundary[word]) << body << ", brick " << i << ", word " << word;
      ASSERT_EQ(a.bricks[i].internal_[word], b.bricks[i].internal_[word]) << body << ", brick " << i << ", word " << word;
      ASSERT_EQ(a.bricks[i].first[word], b.bricks[i].first[word]) << body << ", brick " << i << ", word " << word;
    }
}

}  // namespace palpate
