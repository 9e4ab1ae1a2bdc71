#include "service/loop/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>
#include <vector>

#include "driver/limits.h"
#include "driver/simulated_device.h"
#include "service/loop/control_loop.h"
#include "service/loop/recorder.h"
#include "tests/driver/allocation_count.h"
#include "tests/service/half_space.h"
#include "tests/service/watched_run.h"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// --- Virtual time ---

/// A back end that takes 30 ms a query; nothing that decides may see it, the summary must.
TEST(Session, TellsWhatRealTimeWouldHaveMadeOfIt) {
  LoadedScene scene = half_space_scene();
  add_dip(scene, 0.3);
  scene.scene.control.virtual_delay_ticks = 10;
  std::array<Watcher, 2> watchers;
  std::array<SessionSummary, 2> summaries;
  for (const std::size_t slow : {0u, 1u}) {
    HalfSpace backend;
    if (slow)
      backend.on_query = [](int) -> Result<void> {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        return {};
      };
    WatchedDevice device(scene);
    auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, &watchers[slow]);
    ASSERT_TRUE(summary) << summary.error().sentence;
    summaries[slow] = *summary;
  }
  ASSERT_EQ(watchers[0].ticks.size(), watchers[1].ticks.size());
  for (std::size_t i = 0; i < watchers[0].ticks.size(); ++i) {
    EXPECT_EQ(watchers[0].ticks[i].sent.force, watchers[1].ticks[i].sent.force) << i;
    EXPECT_EQ(watchers[0].ticks[i].result_age_ticks, watchers[1].ticks[i].result_age_ticks) << i;
  }
  // A sleep may take longer than asked, never shorter.
  const SessionSummary& late = summaries[1];
  ASSERT_TRUE(late.realtime);
  EXPECT_FALSE(late.realtime->kept_up);
  EXPECT_GE(late.realtime->watchdog_ticks, 90u) << "10 of every 30 ticks";
  EXPECT_GE(late.realtime->result_age_ticks.max, 59);
  EXPECT_EQ(late.watchdog_ticks, 0u) << "virtual time itself had none";
  EXPECT_THAT(
      late.realtime->sentence,
      HasSubstr("this machine could not have kept up: the watchdog would have faded the force out in "));
  EXPECT_THAT(late.notes,
              testing::Contains(testing::AllOf(
                  HasSubstr("31 of 31 frames took longer than the watchdog's 20 ms; the slowest, "),
                  HasSubstr(" with the tool at 0 0 "))));
}

TEST(Session, SaysThatRealTimeWouldHaveKeptUp) {
  LoadedScene scene = half_space_scene();
  add_dip(scene, 3);
  scene.scene.control.virtual_delay_ticks = 1000;
  scene.scene.control.watchdog_ms = 60'000;
  HalfSpace backend;
  WatchedDevice device(scene);
  const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, nullptr);
  ASSERT_TRUE(summary) << summary.error().sentence;
  ASSERT_TRUE(summary->realtime);
  EXPECT_TRUE(summary->realtime->kept_up);
  EXPECT_THAT(summary->realtime->sentence,
              HasSubstr("this machine would have kept up: results would have been 1 tick old"));
  EXPECT_THAT(summary->realtime->sentence, HasSubstr("(in this run 1"));
  // A run that ends before a result was due says nothing of the machine.
  WatchedDevice brief(scene);
  const auto one = run_session(scene, backend, brief, {.pace = Pace::kAsap, .duration_s = 0.5}, nullptr);
  ASSERT_TRUE(one) << one.error().sentence;
  EXPECT_FALSE(one->realtime);
}

TEST(Session, PressesBackWithTheDepthOfTheContact) {
  LoadedScene scene = half_space_scene();
  add_dip(scene, 2);
  HalfSpace backend;
  WatchedDevice device(scene);
  Watcher watcher;
  const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, &watcher);
  ASSERT_TRUE(summary) << summary.error().sentence;
  EXPECT_EQ(summary->ticks, 2001u) << "the path's last point is part of the run";
  EXPECT_THAT(summary->stages_reached, ElementsAre(1, 2, 3));
  EXPECT_EQ(summary->areas_max, 1u);
  EXPECT_EQ(summary->result_age_ticks.p50, 4);  // 3, 4, 5 in turn
  EXPECT_EQ(summary->result_age_ticks.max, 5);
  EXPECT_EQ(summary->law, "corrected");
  EXPECT_EQ(summary->missed_ticks, 0u);
  EXPECT_EQ(summary->watchdog_ticks, 0u);
  // Static balance of hand (135 N/m) and wall (1000 N/m) against a hand 10 mm deep is 1.19 N; the dip is slow
  // enough for 20 %.
  EXPECT_NEAR(summary->force_max_N, 0.01 * 135 * 1000 / 1135, 0.25);
  for (const TickRecord& tick : watcher.ticks) {
    ASSERT_GE(tick.sent.force.z, 0) << "never pulls";
    // Apart from the ramp at touch and release the law knows the force of this very tick, but that planes are
    // carried on firmer (kFirmer).
    if (tick.contact && tick.pose.position.z < -1e-3) {
      ASSERT_NEAR(tick.sent.force.z, -1000 * tick.pose.position.z, 0.05);
    }
  }
  EXPECT_TRUE(device.closed_at_zero);
}

TEST(Session, WithAVirtualCouplingAWallFeelsNoStifferThanItsSpring) {
  LoadedScene scene = half_space_scene();
  scene.scene.control.coupling_n_per_m = 500;
  add_dip(scene, 2);
  HalfSpace backend;
  WatchedDevice device(scene);
  Watcher watcher;
  ASSERT_TRUE(run_session(scene, backend, device, {.pace = Pace::kAsap}, &watcher));
  int deep = 0;
  for (const TickRecord& tick : watcher.ticks) {
    if (!tick.contact || tick.pose.position.z > -2e-3) continue;
    ++deep;
    // 1000 and 500 N/m in series.
    ASSERT_NEAR(tick.sent.force.z, -tick.pose.position.z * 1000 * 500 / 1500, 0.02);
    // What was asked about is where the tool hangs: a third as deep.
    ASSERT_NEAR(tick.response.force.z, tick.sent.force.z, 0.3);
  }
  EXPECT_GT(deep, 200);
  EXPECT_TRUE(device.closed_at_zero);
}

TEST(Session, HangsTheToolOnASpringOfKByItselfWhereTheProfileIsRefined) {
  for (const Profile profile : {Profile::kRefined, Profile::kPaper}) {
    LoadedScene scene = half_space_scene();
    scene.scene.control.coupling_n_per_m.reset();
    scene.scene.control.coupling_nm_per_rad.reset();
    scene.scene.response.profile = profile;
    add_dip(scene, 2);
    HalfSpace backend;
    WatchedDevice device(scene);
    Watcher watcher;
    ASSERT_TRUE(run_session(scene, backend, device, {.pace = Pace::kAsap}, &watcher));
    int deep = 0;
    for (const TickRecord& tick : watcher.ticks) {
      if (!tick.contact || tick.pose.position.z > -1e-3) continue;
      ++deep;
      ASSERT_NEAR(tick.sent.force.z, -tick.pose.position.z * (profile == Profile::kRefined ? 500 : 1000),
                  0.03)
          << (profile == Profile::kPaper ? "paper" : "refined");
    }
    EXPECT_GT(deep, 100);
  }
}

TEST(Session, CountsFramesWithoutADirectionAndKeepsTheFirst) {
  class Directionless : public HalfSpace {
    Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
      auto done = HalfSpace::query(pose, ignored, out);
      if (out.contact) out.field = {}, out.flags |= kFlagNoDirection;
      return done;
    }
  } backend;
  LoadedScene scene = half_space_scene();
  add_dip(scene, 1);
  WatchedDevice device(scene);
  const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, nullptr);
  ASSERT_TRUE(summary);
  EXPECT_EQ(device.strongest, 0);
  EXPECT_GT(summary->no_direction_frames, 50u);
  EXPECT_GT(summary->no_direction_tick, 200);
  EXPECT_LT(summary->no_direction_pose.position.z, 0);
  ASSERT_FALSE(summary->notes.empty());
  EXPECT_THAT(summary->notes.front(), HasSubstr("in touch where nothing tells the way out"));
}

/// The half-space in three patches of which the tool touches the second and third wherever it is below −4 mm,
/// the second below 0.
class Patched : public HalfSpace {
 public:
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    auto done = HalfSpace::query(pose, ignored, out);
    sets.push_back(ignored ? ignored->patches : std::vector<std::uint32_t>());
    const auto holds = [&](std::uint32_t patch) {
      return std::count(sets.back().begin(), sets.back().end(), patch) > 0;
    };
    if (out.contact && holds(1)) out.field = {}, out.areas.clear(), out.ignored_touched.push_back(1);
    if (pose.translation.z < -4 * 1049 && holds(2)) out.ignored_touched.push_back(2);
    return done;
  }
  std::vector<std::vector<std::uint32_t>> sets;
};

TEST(Session, LeavesContactsOfTheStartOutUntilTheyHaveOpened) {
  LoadedScene scene = half_space_scene();
  scene.geometry.mockup.patch_count = 3;
  scene.scene.start_contacts = StartContacts::kIgnoreInitial;
  // From 8 mm deep up and out, and down again.
  auto& path = scene.scene.device.path;
  path.resize(3);
  for (std::size_t i = 0; i < 3; ++i)
    path[i].time_s = 0.5 * static_cast<double>(i), path[i].pose.position.z = i == 1 ? 0.008 : -0.008;
  scene.scene.start = path.front().pose;
  Patched backend;
  WatchedDevice device(scene);
  Watcher watcher;
  const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, &watcher);
  ASSERT_TRUE(summary) << summary.error().sentence;
  ASSERT_GT(backend.sets.size(), 100u);
  EXPECT_EQ(backend.sets[0], (std::vector<std::uint32_t>{0, 1, 2}))
      << "to begin with, all that may be touched";
  EXPECT_EQ(backend.sets[1], (std::vector<std::uint32_t>{1, 2}));
  EXPECT_TRUE(backend.sets.back().empty());
  EXPECT_EQ(summary->ignored_patches_first, 2u);
  EXPECT_EQ(summary->ignored_patches_end, 0u);
  EXPECT_THAT(summary->notes,
              testing::Contains(HasSubstr("left out on 2 faces of the mock-up; all had opened by the end")));
  double early = 0, late = 0;
  for (const TickRecord& tick : watcher.ticks)
    (tick.time_s < 0.5 ? early : late) = std::max(tick.time_s < 0.5 ? early : late, tick.sent.force.z);
  EXPECT_EQ(early, 0);
  EXPECT_GT(late, 0.2);
}

TEST(Session, GivesResultsTheAgeThatTheSceneConfigures) {
  LoadedScene scene = half_space_scene();
  scene.scene.control.virtual_delay_ticks = 7;
  add_dip(scene, 0.1);
  HalfSpace backend;
  WatchedDevice device(scene);
  Watcher watcher;
  ASSERT_TRUE(run_session(scene, backend, device, {.pace = Pace::kAsap}, &watcher));
  for (std::size_t i = 0; i < watcher.ticks.size(); ++i)
    EXPECT_EQ(watcher.ticks[i].result_age_ticks, i < 7 ? -1 : 7 + static_cast<int>(i % 7)) << i;
  ASSERT_GE(watcher.frame_ticks.size(), 3u);
  EXPECT_EQ(watcher.frame_ticks[1], 7);
  EXPECT_EQ(watcher.frame_ticks[2], 14);
}

TEST(Session, LeavesTheSameBytesEveryTimeInVirtualTime) {
  const auto root = std::filesystem::path(testing::TempDir()) / "palpate_session_test";
  std::vector<std::string> traces;
  for (const char* name : {"a", "b"}) {
    LoadedScene scene = half_space_scene();
    add_dip(scene, 0.5);
    HalfSpace backend;
    // Slow at whim: no clock may show in the trace.
    backend.on_query = [&](int n) {
      if (n % 50 == 0 && *name == 'b') std::this_thread::sleep_for(std::chrono::milliseconds(5));
      return Result<void>();
    };
    WatchedDevice device(scene);
    auto recorder = Recorder::create((root / name).string());
    ASSERT_TRUE(recorder);
    ASSERT_TRUE(run_session(scene, backend, device, {.pace = Pace::kAsap}, recorder->get()));
    ASSERT_TRUE((*recorder)->finish());
    traces.push_back(slurp(root / name / "trace.csv"));
  }
  EXPECT_EQ(traces[0], traces[1]);
  EXPECT_EQ(std::count(traces[0].begin(), traces[0].end(), '\n'), 502);
  EXPECT_THAT(
      traces[0],
      testing::StartsWith(
          "time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,"
          "response_force_x_N,response_force_y_N,response_force_z_N,response_torque_x_Nm,response_torque_y_"
          "Nm,"
          "response_torque_z_Nm,result_age_ticks,contact,stage\n0,0,0,0.01,0,0,0,1,"));
  const std::string frames = slurp(root / "a" / "frames.jsonl");
  EXPECT_THAT(frames, HasSubstr("\"tick\":3"));
  std::filesystem::remove_all(root);
}

TEST(Session, FadesItsForceInAtTheStart) {
  LoadedScene scene = half_space_scene();
  scene.scene.control.fade_in_ms = 100;
  scene.scene.start.position.z = -0.005;  // parts of an assembly touch before anybody moves
  HalfSpace backend;
  WatchedDevice device(scene);
  Watcher watcher;
  ASSERT_TRUE(run_session(scene, backend, device, {.pace = Pace::kAsap, .duration_s = 0.3}, &watcher));
  for (std::size_t i = 0; i < 100; ++i) {
    const double full = -1000 * watcher.ticks[i].pose.position.z;
    EXPECT_LE(watcher.ticks[i].sent.force.z, full * static_cast<double>(i + 1) / 100 + 5e-4)
        << i;  // half a lattice step is 0.5 mN
  }
  EXPECT_EQ(watcher.ticks.size(), 300u);
}

TEST(ControlTick, DoesNotAllocate) {
  LoadedScene scene = half_space_scene();
  auto device = make_simulated_device(scene.scene.device, {}, Vec3(0));
  ASSERT_TRUE(device);
  SafeDevice safe(**device, {});
  ASSERT_TRUE(safe.open());
  const auto tick = std::make_unique<ControlTick>(safe, ForceLawSettings{}, Vec3(0));
  LawResult result;
  result.plane_count = 2;
  const std::size_t before = allocations_of_this_thread();
  for (int i = 0; i < 100; ++i) {
    result.tick = tick->sense(i).tick;
    tick->act(i % 3 == 0 ? &result : nullptr);
  }
  EXPECT_EQ(allocations_of_this_thread(), before);
}

TEST(Session, SaysThatTheSimulatedHandSwingsUnlessItIsWellDamped) {
  const auto swings = [](double damping, bool touches) {
    LoadedScene scene = half_space_scene();
    add_dip(scene, 1);
    if (!touches) scene.scene.device.path[1].pose.position.z = 0.01;
    scene.scene.device.driver = "simulated";
    scene.scene.device.hand_damping_n_s_per_m = damping;
    HalfSpace backend;
    WatchedDevice device(scene);
    const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, nullptr);
    EXPECT_TRUE(summary);
    EXPECT_EQ(summary->force_max_N > 0, touches);
    return testing::Value(
        summary->notes, testing::Contains(HasSubstr("5.2 Hz: such swings")));  // √(1,135 N/m / 1.05 kg) / 2π
  };
  EXPECT_TRUE(swings(6.5, true));
  EXPECT_FALSE(swings(6.5, false));
  EXPECT_FALSE(swings(80, true));
}

TEST(Session, FadesToZeroWhileTheBackEndIsStuckAndKeepsTicking) {
  LoadedScene scene = half_space_scene();
  scene.scene.start.position.z = -0.005;
  scene.scene.device.path.clear();
  HalfSpace backend;
  WatchedDevice device(scene);
  backend.on_query = [&](int n) {
    // The fifth: a busy machine may need a good part of the run for more.
    while (n == 5 && !device.closed.load()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return Result<void>();
  };
  Watcher watcher;
  const auto summary = run_session(scene, backend, device, {.duration_s = 0.25}, &watcher);
  ASSERT_TRUE(summary);
  EXPECT_GT(device.strongest, 0.5);
  EXPECT_GT(summary->watchdog_ticks, 100u);
  EXPECT_EQ(watcher.ticks.back().sent.force, Vec3(0))
      << "long before the run ended the watchdog had taken the force away";
  EXPECT_THAT(summary->notes, testing::Contains(HasSubstr("watchdog")));
}

TEST(Session, RunsInRealTimeOnItsThreads) {
  LoadedScene scene = half_space_scene();
  add_dip(scene, 0.4);
  HalfSpace backend;
  WatchedDevice device(scene);
  Watcher watcher;
  const auto summary = run_session(scene, backend, device, {}, &watcher);
  ASSERT_TRUE(summary) << summary.error().sentence;
  EXPECT_EQ(summary->ticks, 401u);
  EXPECT_EQ(watcher.ticks.size() + summary->dropped_ticks, 401u);
  EXPECT_EQ(watcher.frame_ticks.size() + summary->dropped_frames, summary->frames);
  EXPECT_GT(summary->frames, 10u);
  EXPECT_THAT(summary->stages_reached, ElementsAre(1, 2, 3));
  EXPECT_GT(summary->lateness_us.max, 0);
  for (const TickRecord& tick : watcher.ticks) ASSERT_GE(tick.sent.force.z, 0);
  EXPECT_TRUE(device.closed_at_zero);
}

/// A disk that is slow: its first frame takes as long as 200 queries do.
class SlowWatcher final : public Watcher {
 public:
  Result<void> on_frame(const FrameRecord& frame) override {
    while (frame_ticks.empty() && asked < 200) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (frame.after_gap) {
      after_gap.push_back(frame.tick);
      stop = true;
    }
    return Watcher::on_frame(frame);
  }
  std::atomic<int> asked{0};
  std::atomic<bool> stop{false};
  std::vector<std::int64_t> after_gap;
};

TEST(Session, TellsWhereFramesAreMissingFromTheRecording) {
  const LoadedScene scene = half_space_scene();
  HalfSpace backend;
  WatchedDevice device(scene);
  SlowWatcher watcher;
  backend.on_query = [&](int) {
    ++watcher.asked;
    return Result<void>();
  };
  const auto summary =
      run_session(scene, backend, device, {.duration_s = 60, .stop = &watcher.stop}, &watcher);
  ASSERT_TRUE(summary) << summary.error().sentence;
  EXPECT_GT(summary->dropped_frames, 0u);
  ASSERT_FALSE(watcher.after_gap.empty());
  const auto after = std::find(watcher.frame_ticks.begin(), watcher.frame_ticks.end(), watcher.after_gap[0]);
  ASSERT_NE(after, watcher.frame_ticks.begin());
  EXPECT_GT(*after - *std::prev(after), 1);
}

TEST(Session, RefusesSettingsInOneSentenceBeforeTheDeviceIsTouched) {
  const auto refusal = [](auto change) {
    LoadedScene scene = half_space_scene();
    change(scene.scene);
    HalfSpace backend;
    WatchedDevice device(scene);
    const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap}, nullptr);
    EXPECT_EQ(device.writes, 0);
    return summary ? std::string("accepted") : summary.error().sentence;
  };
  EXPECT_THAT(refusal([](Scene& s) { s.control.transitions = 1001; }),
              HasSubstr("control.transitions is 1001"));
  EXPECT_THAT(refusal([](Scene& s) { s.control.virtual_delay_ticks = 0; }),
              HasSubstr("control.virtual_delay_ticks is 0"));
  EXPECT_THAT(refusal([](Scene& s) { s.control.watchdog_ms = NAN; }),
              HasSubstr("control.watchdog_ms is nan"));
  EXPECT_THAT(refusal([](Scene& s) { s.control.slew_ms = -1; }), HasSubstr("control.slew_ms is -1"));
  EXPECT_THAT(refusal([](Scene& s) { s.control.change_n_per_s = NAN; }),
              HasSubstr("control.change_n_per_s is nan"));
  EXPECT_THAT(refusal([](Scene& s) { s.control.coupling_n_per_m = NAN; }),
              HasSubstr("control.coupling_n_per_m is nan"));
  EXPECT_THAT(
      refusal([](Scene& s) { s.control.coupling_nm_per_rad = 2, s.control.law = ForceLaw::kPrinted; }),
      HasSubstr("control.coupling_nm_per_rad is 2, allowed is 0 with law printed"));
  EXPECT_THAT(refusal([](Scene& s) { s.response.stiffness_n_per_m = -1; }),
              HasSubstr("response.stiffness is -1"));
}

}  // namespace
}  // namespace palpate
