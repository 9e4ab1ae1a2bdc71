// The report's curves lose no peak, and its stretch lies round the strongest contact.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "service/report/report_series.h"

namespace palpate {
namespace {

nlohmann::json extremes(const Envelope& envelope) {
  std::string text;
  envelope.append_extremes(text);
  return nlohmann::json::parse(text);
}

TEST(Envelope, KeepsEveryPointWhileThereIsRoom) {
  Envelope envelope;
  for (int i = 0; i < 100; ++i) envelope.push(i, i * i);
  const auto points = extremes(envelope);
  ASSERT_EQ(points.size(), 100u);
  EXPECT_EQ(points[7][0], 7);
  EXPECT_EQ(points[7][1], 49);
}

TEST(Envelope, KeepsEveryLonePeakAndDipOfALongCurve) {
  // One peak and one dip now and then, at places of all parities, far enough apart for bins of their own.
  const auto peak = [](int i) { return i % 10007 == 5; };
  const auto dip = [](int i) { return i % 10007 == 5003; };
  Envelope envelope;
  constexpr int kCount = 123457;
  for (int i = 0; i < kCount; ++i) envelope.push(i, peak(i) ? 5.0 : dip(i) ? -3.0 : 0.0);
  const auto points = extremes(envelope);
  EXPECT_LE(points.size(), 1600u) << "memory stays bounded";
  int peaks = 0, dips = 0;
  double last_x = -1;
  for (const auto& point : points) {
    const double x = point[0], y = point[1];
    peaks += y == 5.0 && peak(static_cast<int>(x));
    dips += y == -3.0 && dip(static_cast<int>(x));
    EXPECT_GT(x, last_x) << "x ascends";
    last_x = x;
  }
  EXPECT_EQ(peaks, 13);
  EXPECT_EQ(dips, 12);
}

TEST(Envelope, MeansKeepTheSum) {
  Envelope envelope;
  for (int i = 0; i < 1600; ++i) envelope.push(i, i % 2);  // two points a bin
  std::string text;
  envelope.append_means(text);
  for (const auto& point : nlohmann::json::parse(text)) EXPECT_EQ(point[1], 0.5);
}

TickRecord tick_with_force(int tick, double force) {
  TickRecord record;
  record.tick = tick;
  record.response.force.x = force;
  return record;
}

TEST(Highlight, LiesRoundTheStrongestContact) {
  Highlight highlight;
  for (int i = 0; i < 5000; ++i)
    highlight.push(tick_with_force(i, i == 900 ? 3 : i == 3000 ? 7 : i == 4500 ? 5 : 0));
  const auto ticks = highlight.ticks();
  ASSERT_EQ(ticks.size(), 200u);
  EXPECT_LT(ticks.front().tick, 3000);
  EXPECT_GT(ticks.back().tick, 3000);
  EXPECT_NEAR(static_cast<double>(3000 - ticks.front().tick), 100, 1);
}

TEST(Highlight, EndsWithTheRun) {
  Highlight highlight;
  for (int i = 0; i <= 50; ++i) highlight.push(tick_with_force(i, i));
  EXPECT_EQ(highlight.ticks().size(), 51u);
}

TEST(Highlight, IsEmptyWithoutContact) {
  Highlight highlight;
  for (int i = 0; i < 500; ++i) highlight.push(tick_with_force(i, 0));
  EXPECT_TRUE(highlight.ticks().empty());
}

}  // namespace
}  // namespace palpate
