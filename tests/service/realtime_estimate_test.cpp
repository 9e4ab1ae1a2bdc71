#include "service/loop/realtime_estimate.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace palpate {
namespace {

/// A run of `ticks`, a frame at every `delay`-th, each as long as `us` says for its tick.
template <class Us>
RealtimeEstimate estimated(int ticks, int delay, int watchdog_ticks, Us us) {
  RealtimeEstimate estimate(watchdog_ticks);
  for (int i = 0; i < ticks; ++i) {
    if (i % delay == 0) estimate.frame(i, us(i));
    estimate.tick(i);
  }
  return estimate;
}

TEST(RealtimeEstimate, AFrameWithinATickIsATickOld) {
  const auto estimate = estimated(1000, 3, 20, [](int) { return 300.0; });
  EXPECT_EQ(estimate.result_age().total(), 999u) << "the first result comes at tick 1";
  EXPECT_EQ(estimate.result_age().percentile(0.001), 1);
  EXPECT_EQ(estimate.result_age().max(), 1);
  EXPECT_EQ(estimate.watchdog_ticks(), 0u);
}

TEST(RealtimeEstimate, AFrameOfFourTicksIsFourToSevenOld) {
  const auto estimate = estimated(4000, 1, 20, [](int) { return 4000.0; });
  EXPECT_EQ(estimate.result_age().total(), 3996u);
  EXPECT_EQ(estimate.result_age().percentile(0.25), 4);
  EXPECT_EQ(estimate.result_age().percentile(0.5), 5);
  EXPECT_EQ(estimate.result_age().percentile(0.75), 6);
  EXPECT_EQ(estimate.result_age().max(), 7);
}

/// Queries at 0 and 3.5 ms, for the poses of ticks 0 and 3, answered at ticks 4 and 7, and so on every 7.
TEST(RealtimeEstimate, TheNextQueryBeginsBetweenTicksWithTheNewestPose) {
  const auto estimate = estimated(7 * 100 + 4, 1, 20, [](int) { return 3500.0; });
  // Ages at ticks 4, 5, 6 of pose 0: 4, 5, 6; at 7 to 10 of pose 3: 4, 5, 6, 7.
  std::vector<std::uint64_t> counts;
  estimate.result_age().each(false, [&](double, double, std::uint64_t count) { counts.push_back(count); });
  EXPECT_EQ(counts, (std::vector<std::uint64_t>{200, 200, 200, 100}));
}

TEST(RealtimeEstimate, TheWatchdogRunsOutWhileAFrameTakesLonger) {
  // Of 30 ticks between two answers, 20 pass before it does.
  const auto estimate = estimated(3000, 3, 20, [](int) { return 30'000.0; });
  EXPECT_EQ(estimate.watchdog_ticks(), 1000u);
  EXPECT_EQ(estimate.result_age().max(), 59);
  EXPECT_EQ(estimated(3000, 3, 0, [](int) { return 30'000.0; }).watchdog_ticks(), 0u) << "there is none";
  EXPECT_EQ(estimated(3000, 3, 20, [](int) { return 20'000.0; }).watchdog_ticks(), 0u)
      << "fresh in the very tick";
}

TEST(RealtimeEstimate, ASingleSlowPoseIsTheRunsOwn) {
  // One query of 100 ms among short ones: the results stay away for 100 ticks, 20 of which the watchdog
  // waits.
  const auto estimate = estimated(1000, 4, 20, [](int tick) { return tick == 400 ? 100'000.0 : 500.0; });
  EXPECT_EQ(estimate.watchdog_ticks(), 80u);
  EXPECT_EQ(estimate.result_age().max(), 100) << "at tick 499, of pose 399";
  EXPECT_EQ(estimate.result_age().percentile(0.8), 1);
}

TEST(RealtimeEstimate, WithoutAnAnswerThereIsNoAge) {
  const auto estimate = estimated(50, 4, 20, [](int) { return 1e6; });
  EXPECT_EQ(estimate.result_age().total(), 0u);
  EXPECT_EQ(estimate.watchdog_ticks(), 30u);
}

}  // namespace
}  // namespace palpate
