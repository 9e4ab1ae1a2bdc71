#include "service/report/chart_svg.h"

#include <gtest/gtest.h>

#include "service/report/chart_axis.h"

namespace palpate {
namespace {

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++n;
  return n;
}

TEST(ChartSvg, DrawsWhatTheoryExpectsDashedInTheInkOfWhatItIsOf) {
  Chart chart;
  chart.title = "K < all & more";
  chart.log_x = chart.log_y = true;
  chart.series = {
      {"law", {1, 10}, {100, 50}}, {"law, theory", {1, 10}, {110, 55}, true}, {"other", {1, 10}, {7, 8}}};
  const std::string picture = chart_svg(chart);
  // Theory has no dots, and the legend shows each series as it is drawn.
  EXPECT_EQ(count(picture, "<circle"), 4u + 2u);
  EXPECT_EQ(count(picture, "stroke-dasharray"), 1u + 1u);
  EXPECT_EQ(count(picture, "stroke=\"#4269d0\""), 2u + 2u);
  EXPECT_EQ(count(picture, "<rect"), 1u);  // the ground
  EXPECT_NE(picture.find("K &lt; all &amp; more"), std::string::npos);
}

TEST(ChartSvg, AMapHasACellAValueAndDarkensWithIt) {
  Chart chart;
  chart.map = true;
  chart.labels = {"1", "2", "5"};
  chart.series = {{"n 1", {}, {10, 100, 1000}}, {"n 2", {}, {20, 200, 0}}};
  const std::string picture = chart_svg(chart);
  EXPECT_EQ(count(picture, "<rect"), 1u + 6u);  // the ground and the cells
  for (const char* value : {">10<", ">100<", ">1000<", ">20<", ">200<", ">0<", ">n 1<", ">n 2<", ">5<"})
    EXPECT_NE(picture.find(value), std::string::npos) << value;
  EXPECT_EQ(count(picture, "rgb(255,247,203)"), 2u) << "the least value and none";
  EXPECT_EQ(count(picture, "rgb(37,52,148)"), 1u) << "the largest";
  chart.map_low = 1000, chart.map_high = 1e6;
  EXPECT_EQ(count(chart_svg(chart), "rgb(255,247,203)"), 6u) << "the least of the scale, and what is below";
}

TEST(ChartSvg, BarsStandBesideOrOnEachOther) {
  Chart chart;
  chart.labels = {"a", "b"};
  chart.series = {{"x", {}, {1, 2}}, {"y", {}, {3, 0}}};
  const std::string beside = chart_svg(chart);
  EXPECT_EQ(count(beside, "<rect"), 1u + 3u + 2u);  // the ground, a bar a value but for nothing, the legend
  EXPECT_NE(beside.find("height=\"330.0\""), std::string::npos) << "the largest, 3, fills the plot";
  chart.stacked = true;
  const std::string stacked = chart_svg(chart);
  EXPECT_NE(stacked.find("height=\"247.5\""), std::string::npos) << "3 of 4";
}

TEST(ChartSvg, TicksAreWrittenAsPeopleWriteThem) {
  EXPECT_EQ(tick_text(0.001), "0.001");
  EXPECT_EQ(tick_text(1e-7), "1e-07");
  EXPECT_EQ(tick_text(100), "100");
  EXPECT_EQ(tick_text(1000), "1,000");
  EXPECT_EQ(tick_text(20'000), "20,000");
  EXPECT_EQ(tick_text(-1005), "-1,005");
  EXPECT_EQ(tick_text(1e6), "1e+06");
}

TEST(ChartSvg, WhatDivergedIsMarkedAtTheEdgeAndStretchesNoAxis) {
  Chart chart;
  chart.log_y = true;
  chart.y_most = 10;
  chart.series = {{"a", {1, 2, 3}, {1, 5, 1e104}}};
  const std::string picture = chart_svg(chart);
  EXPECT_EQ(count(picture, "<circle"), 2u + 1u);  // the legend's
  EXPECT_EQ(count(picture, "l5 9h-10Z"), 1u);
  EXPECT_EQ(picture.find("1e+104"), std::string::npos);
}

}  // namespace
}  // namespace palpate
