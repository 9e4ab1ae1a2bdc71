#include "service/loop/frame_budget.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace palpate {
namespace {

/// A frame whose samples take `field_us` where all of them count, half as long a level coarser, beside
/// `rest_us`.
void ask(FrameBudget& budget, double rest_us, double field_us) {
  const double field = field_us * std::exp2(-static_cast<double>(budget.coarser()) / 256);
  budget.frame(rest_us + field, field);
}

TEST(FrameBudget, LongFramesComeToTheBudgetAndShortOnesToAllSamples) {
  FrameBudget budget(4000);
  for (int i = 0; i < 100; ++i) ask(budget, 2000, 8000);
  const std::uint32_t settled = budget.coarser();
  EXPECT_NEAR(settled, 512, 16) << "a quarter of the samples";
  for (int i = 0; i < 100; ++i) {
    ask(budget, 2000, 8000);
    EXPECT_EQ(budget.coarser(), settled) << "does not swing";
  }
  for (int i = 0; i < 1000; ++i) ask(budget, 500, 1000);
  EXPECT_EQ(budget.coarser(), 0u);
  EXPECT_EQ(budget.coarsest(), settled);
  EXPECT_GE(budget.coarse_frames(), 200u);
}

TEST(FrameBudget, NoFrameIsMuchCoarserThanTheOneBefore) {
  FrameBudget budget(4000);
  int last = 0;
  for (int i = 0; i < 300; ++i) {
    ask(budget, i % 7 == 0 ? 30'000 : 100, i % 50 < 25 ? 60'000 : 10);
    EXPECT_LE(std::abs(static_cast<int>(budget.coarser()) - last), 16) << i;
    last = static_cast<int>(budget.coarser());
  }
}

TEST(FrameBudget, WhereSamplesTakeLittleNoneAreLeftOut) {
  FrameBudget budget(4000);
  for (int i = 0; i < 100; ++i) ask(budget, 9000, 1000);
  EXPECT_EQ(budget.coarser(), 0u);
}

TEST(FrameBudget, FewerThanAQuarterCountOnlyWhereTheyTakeHalfOfAFrame) {
  FrameBudget little(4000), much(4000);
  for (int i = 0; i < 300; ++i) {
    ask(little, 3900, 8000);
    ask(much, 1000, 40'000);
  }
  EXPECT_NEAR(little.coarser(), 512, 16) << "a third of a frame is not worth a rough force";
  EXPECT_GT(much.coarser(), 900u) << "some 1,000 us and a 13th of the samples are within the budget";
}

TEST(FrameBudget, ThereIsAnEndToIt) {
  FrameBudget budget(1);
  for (int i = 0; i < 1000; ++i) budget.frame(10'000, 9000);
  EXPECT_EQ(budget.coarser(), Ignored::kCoarsest);
}

TEST(FrameBudget, NoBudgetNothingLeftOut) {
  FrameBudget budget(0);
  for (int i = 0; i < 100; ++i) budget.frame(1e6, 1e6);
  EXPECT_EQ(budget.coarser(), 0u);
  EXPECT_EQ(budget.coarse_frames(), 0u);
}

}  // namespace
}  // namespace palpate
