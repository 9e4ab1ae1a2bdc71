#include "service/queries/portions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

namespace palpate {
namespace {

/// The sizes of all portions where each pose takes so long, by a clock that nobody waits for.
std::vector<std::size_t> sizes(std::size_t count, std::size_t most, std::vector<double> seconds_a_pose) {
  std::vector<std::size_t> out;
  Portions::Clock::time_point now{};
  Portions portions(count, most);
  for (std::size_t i = 0, expected = 0; portions.next(now); expected += out.back()) {
    EXPECT_EQ(portions.first(), expected);
    out.push_back(portions.count());
    for (std::size_t k = 0; k < portions.count(); ++k) {
      const double seconds = seconds_a_pose[std::min(i++, seconds_a_pose.size() - 1)];
      now += std::chrono::duration_cast<Portions::Clock::duration>(std::chrono::duration<double>(seconds));
    }
  }
  return out;
}

TEST(Portions, GrowWhereTheyTakeLittle) {
  EXPECT_EQ(sizes(10'000, 4096, {1e-6}), (std::vector<std::size_t>{16, 256, 4096, 4096, 1536}));
  EXPECT_EQ(sizes(400, 100, {1e-6}), (std::vector<std::size_t>{16, 100, 100, 100, 84}));
}

TEST(Portions, StaySmallWhereTheyTakeLong) {
  EXPECT_EQ(sizes(40, 4096, {0.5}), (std::vector<std::size_t>{16, 16, 8}));
  EXPECT_EQ(sizes(40, 4096, {0.01}), (std::vector<std::size_t>{16, 16, 8}));
}

/// A tool that is free at first and then pressed in.
TEST(Portions, ShrinkOnceTheyTakeLong) {
  std::vector<double> seconds(16 + 256, 4e-4);
  seconds.push_back(0.1);
  EXPECT_EQ(sizes(600, 4096, seconds), (std::vector<std::size_t>{16, 256, 256, 16, 16, 16, 16, 8}));
}

TEST(Portions, OfNothingAreNone) {
  EXPECT_TRUE(sizes(0, 4096, {1}).empty());
  EXPECT_EQ(sizes(1, 4096, {1}), std::vector<std::size_t>{1});
}

}  // namespace
}  // namespace palpate
