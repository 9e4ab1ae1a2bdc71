#include "compute/native/frame_helper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <new>
#include <thread>
#include <vector>

#include "model/processors.h"

namespace palpate {
namespace {

/// Rounds of all sizes, one right after the other: each part once, the first ones in the asker's lane, the
/// others in the helper's, and what it left is there afterwards.
TEST(FrameHelper, DoesEachPartOnce) {
  const auto helper = FrameHelper::make();
  ASSERT_EQ(helper == nullptr, processors() < 2);
  std::vector<std::uint32_t> times(300);  // each part its own word, no atomics: a thread sanitizer looks on
  std::vector<int> lanes(times.size());
  std::array<std::uint64_t, FrameHelper::kLanes> sums{};
  for (std::uint32_t round = 0; round < 3000; ++round) {
    const std::uint32_t parts = round * 7 % 300;
    times.assign(times.size(), 0);
    sums = {};
    share_parts(helper.get(), parts, [&](std::uint32_t part, int lane) {
      ++times[part];
      lanes[part] = lane;
      sums[static_cast<std::size_t>(lane)] += part;
    });
    for (std::uint32_t i = 0; i < times.size(); ++i)
      ASSERT_EQ(times[i], i < parts ? 1u : 0u) << "part " << i << " of " << parts << " in round " << round;
    ASSERT_TRUE(std::is_sorted(lanes.begin(), lanes.begin() + parts)) << parts << " in round " << round;
    ASSERT_EQ(sums[0] + sums[1], std::uint64_t{parts} * (parts - (parts > 0 ? 1 : 0)) / 2);
  }
}

TEST(FrameHelper, BothThreadsTakePart) {
  const auto helper = FrameHelper::make();
  if (!helper) return;  // one processor: DoesEachPartOnce has said so
  // Each part waits for the other: alone this would never end.
  std::atomic<int> begun{0};
  std::array<std::atomic<int>, FrameHelper::kLanes> by{};
  helper->share(2, [&](std::uint32_t, int lane) {
    ++by[static_cast<std::size_t>(lane)];
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_EQ(by[0], 1);
  EXPECT_EQ(by[1], 1);
}

TEST(FrameHelper, ComesOutOfItsSleep) {
  const auto helper = FrameHelper::make();
  if (!helper) return;  // one processor: DoesEachPartOnce has said so
  for (int round = 0; round < 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // far longer than it looks out for work
    std::atomic<int> begun{0};
    helper->share(2, [&](std::uint32_t, int) {
      ++begun;
      while (begun < 2) std::this_thread::yield();
    });
    EXPECT_EQ(begun, 2);
  }
}

/// No memory in either thread is the asker's to hear, after the other has ended, and the next round is none
/// the worse.
TEST(FrameHelper, ThrowsOnWhatAPartThrew) {
  const auto helper = FrameHelper::make();
  if (!helper) return;  // one processor: DoesEachPartOnce has said so
  for (const int failing : {0, 1}) {
    std::atomic<int> begun{0};
    EXPECT_THROW(helper->share(2,
                               [&](std::uint32_t, int lane) {
                                 ++begun;
                                 while (begun < 2) std::this_thread::yield();
                                 if (lane == failing) throw std::bad_alloc();
                               }),
                 std::bad_alloc)
        << "lane " << failing;
    int done = 0;
    share_parts(helper.get(), 1, [&](std::uint32_t, int) { ++done; });
    EXPECT_EQ(done, 1);
    std::atomic<int> all{0};
    EXPECT_NO_THROW(helper->share(10, [&](std::uint32_t, int) { ++all; }));
    EXPECT_EQ(all, 10);
  }
}

}  // namespace
}  // namespace palpate
