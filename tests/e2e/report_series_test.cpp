// The report's curves lose no peak, and its stretch lies round the strongest contact.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/report/report_series.h"
#include "service/report/run_difference.h"

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

TEST(Highlight, OfAStageIsRoundItsLargestTorqueAboutX) {
  Highlight highlight(3);
  for (int i = 0; i < 3000; ++i) {
    TickRecord tick = tick_with_force(i, i == 500 ? 9 : 1);
    tick.stage = i < 1000 ? 2 : 3;
    tick.response.torque.x = i == 700 ? 5 : i == 2000 ? -2 : 0.1;  // the first in another stage
    highlight.push(tick);
  }
  const auto ticks = highlight.ticks();
  ASSERT_EQ(ticks.size(), 200u);
  EXPECT_EQ(ticks[ticks.size() / 2 - 1].tick, 2000);
}

nlohmann::json steps_of(const ForceSteps& steps) {
  std::string text;
  steps.append_steps(text);
  return nlohmann::json::parse(text);
}

TEST(ForceSteps, CountsEveryStepOnceBySize) {
  ForceSteps steps;
  for (int i = 0; i < 10; ++i) steps.push(Vec3(i >= 5 ? 0.3 : 0, i >= 8 ? 0.02 : 0, 0));
  EXPECT_EQ(steps.still(), 7u);
  EXPECT_DOUBLE_EQ(steps.largest(), 0.3);
  const auto bins = steps_of(steps);
  ASSERT_EQ(bins.size(), 2u);
  EXPECT_LE(bins[0][0], 0.02);
  EXPECT_GT(bins[0][1], 0.02);
  EXPECT_LE(bins[1][0], 0.3);
  EXPECT_GT(bins[1][1], 0.3);
}

TEST(ForceSteps, TheSpectrumOfASineHasItsPowerAtItsFrequency) {
  ForceSteps steps;
  // 125 Hz is bin 128 of 1,024 at 1 kHz; the mean, 3 N, has no place in it. Power of 2 sin: 2 N².
  for (int i = 0; i < 8192; ++i) steps.push(Vec3(3, 2 * std::sin(2 * 3.14159265358979 * 0.125 * i), 0));
  std::string text;
  steps.append_spectrum(text);
  const auto spectrum = nlohmann::json::parse(text);
  ASSERT_EQ(spectrum.size(), 512u);
  double power = 0;
  std::size_t highest = 0;
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    power += spectrum[k][1].get<double>() * 1000.0 / 1024;
    if (spectrum[k][1] > spectrum[highest][1]) highest = k;
  }
  EXPECT_EQ(spectrum[highest][0], 125);
  EXPECT_NEAR(power, 2, 1e-3);  // four printed digits
}

TEST(WorkGiven, IsForceTimesWayAndTorqueTimesTurnAboutTheCentreOfMass) {
  const Vec3 gc(0.1, 0, 0);
  WorkGiven work(gc);
  TickRecord tick;
  tick.sent = {Vec3(0, 2, 0), Vec3(0, 0, 3)};
  EXPECT_EQ(work.push(tick), 0);
  tick.pose.position = Vec3(0, 0.5, 0);  // 2 N over half a metre
  EXPECT_NEAR(work.push(tick), 1, 1e-12);
  // A turn of 0.2 about z through the centre of mass, which stays: 3 N·m times 0.2.
  const Quat turn = glm::angleAxis(0.2, Vec3(0, 0, 1));
  tick.pose = {Vec3(0, 0.5, 0) + gc - turn * gc, turn};
  EXPECT_NEAR(work.push(tick), 1.6, 1e-12);
}

TEST(ReportSeries, AFrameBelongsToTheStageOfItsTickWhicheverComesFirst) {
  const auto tick_at = [](int i) {
    TickRecord tick = tick_with_force(i, 1);
    tick.time_s = i * 1e-3;
    tick.stage = i < 100 ? 1 : 2;
    return tick;
  };
  const Pose pose;
  const LatticePose lattice_pose{};
  const Contacts contacts;
  const ContactResponse response;
  const auto frame_at = [&](int i) {
    return FrameRecord{i, pose, lattice_pose, contacts, response, static_cast<double>(i)};
  };
  // Records of frames may all come first, all last, or in turns; some are lost.
  for (const int order : {0, 1, 2}) {
    ReportSeries series;
    const auto frames = [&] {
      for (int i = 0; i < 200; i += 10) EXPECT_TRUE(series.on_frame(frame_at(i)));
    };
    if (order == 0) frames();
    for (int i = 0; i < 200; ++i) {
      if (order == 2 && i % 10 == 0) {
        EXPECT_TRUE(series.on_frame(frame_at(i)));
      }
      EXPECT_TRUE(series.on_tick(tick_at(i)));
    }
    if (order == 1) frames();
    const auto stages = series.stages();
    ASSERT_EQ(stages.size(), 2u) << order;
    for (const auto& [stage, figures] : stages) {
      EXPECT_EQ(figures.frames, 10) << order << ": " << stage;
      EXPECT_EQ(figures.frame_us_max, stage == 1 ? 90 : 190) << order << ": " << stage;
      EXPECT_EQ(figures.frame_us_sum, stage == 1 ? 450 : 1450) << order << ": " << stage;
    }
  }
}

TEST(ReportSeries, ChartsOfFramesHaveAGapWhereNothingWasRecorded) {
  const Pose pose;
  const LatticePose lattice_pose{};
  Contacts contacts;
  contacts.times.push_back({"field", 1});
  const ContactResponse response;
  ReportSeries series;
  for (int i = 0; i < 1000; ++i) {
    if (i >= 300 && i < 500) continue;  // a gap that is seen
    if (i == 700) continue;             // and one narrower than a chart's line
    ASSERT_TRUE(
        series.on_frame({i, pose, lattice_pose, contacts, response, 5, /*after_gap=*/i == 500 || i == 701}));
    ASSERT_TRUE(series.on_tick(tick_with_force(i, 1)));
  }
  const nlohmann::json data = nlohmann::json::parse("{" + series.json({}) + "}");
  for (const nlohmann::json& curve : {data["curves"]["frame_us"], data["curves"]["cst"],
                                      data["curves"]["depth"], data["stage_us"]["field"]}) {
    std::vector<double> gaps;
    for (const auto& point : curve)
      if (point[1].is_null()) gaps.push_back(point[0]);
    EXPECT_THAT(gaps, testing::ElementsAre(testing::DoubleNear(0.3995, 1e-9)));
  }
  for (const auto& point : data["curves"]["sent_force_x"]) EXPECT_FALSE(point[1].is_null());
}

TEST(ReportSeries, RemembersTheLongestOfManyGaps) {
  Gaps gaps;
  for (int i = 0; i < 10'000; ++i) gaps.push(i, i + (i % 1000 == 0 ? 0.9 : 0.001));
  const auto seen = gaps.seen_over(300);
  ASSERT_EQ(seen.size(), 10u);
  EXPECT_EQ(seen[3], (std::array<double, 2>{3000, 3000.9}));
}

TEST(ReportSeries, AStageIsShownWhereTheToolIsPushedHardest) {
  const LatticePose lattice_pose{};
  const Contacts contacts;
  ReportSeries series;
  for (int i = 0; i < 100; ++i) {
    // The device is further in than the tool, which hangs on it.
    TickRecord tick = tick_with_force(i, i == 60 ? 7 : 1);
    tick.stage = 1;
    tick.pose.position.z = -0.01;
    ContactResponse response;
    response.wrench.force.z = i == 40 ? 5 : 1;
    Pose pose;
    pose.position.z = -0.0001 * i;
    ASSERT_TRUE(series.on_frame({i, pose, lattice_pose, contacts, response, 5}));
    ASSERT_TRUE(series.on_tick(tick));
  }
  const StageFigures stage = series.stages().at(1);
  EXPECT_EQ(stage.pose.position.z, -0.004);
  EXPECT_EQ(stage.at_s, 0.04);
  ReportSeries without;  // frames, none of which was recorded
  for (int i = 0; i < 100; ++i) {
    TickRecord tick = tick_with_force(i, i == 60 ? 7 : 1);
    tick.stage = 1;
    tick.pose.position.z = -0.01 * i;
    ASSERT_TRUE(without.on_tick(tick));
  }
  EXPECT_EQ(without.stages().at(1).pose.position.z, -0.6);
}

RecordedRun run_of(int ticks, double force, const char* summary) {
  RecordedRun run{.folder = "run", .summary = summary, .ticks = {}};
  for (int i = 0; i < ticks; ++i) {
    RecordedTick tick;
    tick.tick = i;
    tick.time_s = i * 1e-3;
    tick.sent.force.x = i < 5 ? 1 : force;
    run.ticks.push_back(tick);
  }
  return run;
}

TEST(RunDifference, TellsWhereAndByHowMuch) {
  const RecordedRun one =
      run_of(10, 1, R"({"ticks":10,"force_max_N":2.0,"provenance":{"commit":"a"},"notes":["x"]})");
  const RunDifference same = difference_of(one, one);
  EXPECT_TRUE(same.same_trace());
  EXPECT_TRUE(same.facts.empty());
  const RunDifference other =
      difference_of(one, run_of(12, 4, R"({"force_max_N":3.0,"ticks":10,"provenance":{"commit":"b"}})"));
  EXPECT_FALSE(other.same_trace());
  EXPECT_EQ(other.common, 10u);
  EXPECT_EQ(other.only_second, 2u);
  EXPECT_EQ(other.quantities[4].largest, 3);
  EXPECT_EQ(other.quantities[4].first_at_s, 0.005);
  EXPECT_NEAR(other.quantities[4].rms, 3 * std::sqrt(0.5), 1e-12);
  EXPECT_FALSE(other.quantities[2].first_at_s);
  ASSERT_EQ(other.facts.size(), 2u);
  EXPECT_EQ(other.facts[0].name, "provenance commit");
  EXPECT_EQ(other.facts[1].name, "force max N");
  EXPECT_EQ(other.facts[1].ratio, 1.5);
}

}  // namespace
}  // namespace palpate
