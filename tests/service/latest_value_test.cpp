#include "model/latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "service/loop/histogram.h"

namespace palpate {
namespace {

TEST(LatestValue, GivesEachValueOnceAndTheNewestOnly) {
  LatestValue<int> box;
  EXPECT_EQ(box.take(), nullptr);
  box.publish(1);
  box.publish(2);
  const int* taken = box.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 2);
  EXPECT_EQ(box.take(), nullptr);
  box.publish(3);
  box.publish(4);
  box.publish(5);
  EXPECT_EQ(*taken, 2) << "what was taken stays while the writer goes on";
  taken = box.take();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 5);
}

TEST(LatestValue, NeverShowsAValueHalfWritten) {
  struct Wide {
    std::array<std::uint64_t, 64> words{};
  };
  constexpr std::uint64_t kLast = 50000;
  LatestValue<Wide> box;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) {
      Wide value;
      value.words.fill(i);
      box.publish(value);
    }
  });
  std::uint64_t before = 0;
  while (before < kLast) {
    const Wide* value = box.take();
    if (!value) continue;
    ASSERT_GT(value->words[0], before) << "values come in order";
    before = value->words[0];
    for (const std::uint64_t word : value->words) ASSERT_EQ(word, before);
  }
  writer.join();
}

TEST(Histogram, IsExactForSmallValuesAndWithinTwoPercentForLargeOnes) {
  Histogram small, large;
  for (int i = 1; i <= 100; ++i) small.add(i);
  EXPECT_EQ(small.percentile(0.5), 50);
  EXPECT_EQ(small.percentile(0.99), 99);
  EXPECT_EQ(small.percentile(1), 100);
  for (std::int64_t i = 1; i <= 100000; ++i) large.add(i * 1000);
  EXPECT_NEAR(large.percentile(0.5) / 50e6, 1, 0.016);
  EXPECT_NEAR(large.percentile(0.999) / 99.9e6, 1, 0.016);
  EXPECT_EQ(large.max(), 1e8);
  large.add(INT64_MAX);
  EXPECT_EQ(large.percentile(1), static_cast<double>(INT64_MAX));
}

TEST(Histogram, CountsANegativeValueAsZero) {
  Histogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.percentile(0.5), 0);
  EXPECT_EQ(histogram.total(), 1u);
}

}  // namespace
}  // namespace palpate
