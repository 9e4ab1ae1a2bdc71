// Another plan in mid-run: the loop goes on, what a person can't feel changes no tick, and another profile
// fades in.
#include "service/loop/plan_switch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include "driver/simulated_device.h"
#include "service/loop/session.h"
#include "tests/service/half_space.h"

namespace palpate {
namespace {

/// A half-space that keeps the plan that it was prepared for.
class Planned : public HalfSpace {
 public:
  Result<void> prepare(const SceneGeometry&, const Plan& wanted, const Progress& progress) override {
    if (on_prepare)
      if (auto done = on_prepare(progress); !done) return done;
    plan = wanted;
    ++prepared;
    return {};
  }
  Plan plan;
  int prepared = 0;
  std::function<Result<void>(const Progress&)> on_prepare;
};

class Ticks : public RunObserver {
 public:
  Result<void> on_tick(const TickRecord& tick) override {
    ticks.push_back(tick);
    seen.store(static_cast<int>(ticks.size()));
    return {};
  }
  std::vector<TickRecord> ticks;
  std::atomic<int> seen{0};
};

struct Ran {
  SessionSummary summary;
  std::vector<TickRecord> ticks;
  int by_first = 0, by_other = 0;
};

PlanTarget target(Profile profile, bool telemetry, bool torques = true) {
  PlanTarget out;
  out.plan.profile = profile;
  out.plan.telemetry = telemetry;
  out.torques = torques;
  return out;
}

/// A dip of a second in virtual time, with these changes.
Ran run(const std::vector<PlanChange>& changes, std::function<Result<void>(const Progress&)> on_prepare = {},
        const std::function<void(Scene&)>& change = {}) {
  LoadedScene scene = half_space_scene();
  scene.scene.control.fade_in_ms = 100;
  if (change) change(scene.scene);
  add_dip(scene, 1);
  Planned first;
  auto owned = std::make_unique<Planned>();
  Planned& other = *owned;
  other.on_prepare = std::move(on_prepare);
  PlanSwitch plans(scene.geometry, std::move(owned));
  auto device = make_simulated_device(scene.scene.device, scene.scene.start, Vec3(0));
  Ticks ticks;
  SessionOptions options{.pace = Pace::kAsap};
  options.plans = &plans;
  options.changes = changes;
  auto summary = run_session(scene, first, **device, options, &ticks);
  if (!summary) throw std::runtime_error(summary.error().sentence);
  return {*summary, ticks.ticks, first.queries, other.queries};
}

TEST(PlanSwitch, AViewerThatComesChangesNoTick) {
  const Ran still = run({}),
            changed = run({{400, target(Profile::kRefined, true)}, {700, target(Profile::kRefined, false)}});
  ASSERT_EQ(still.ticks.size(), 1001u);
  ASSERT_EQ(changed.ticks.size(), 1001u);
  EXPECT_EQ(changed.summary.missed_ticks, 0u);
  EXPECT_EQ(changed.summary.plan_changes, 2u);
  EXPECT_EQ(still.summary.plan_changes, 0u);
  EXPECT_GT(changed.by_other, 90) << "the second back end answered meanwhile";
  EXPECT_GT(changed.by_first, 200) << "and the first before and after";
  EXPECT_EQ(changed.by_first + changed.by_other, still.by_first);
  for (std::size_t i = 0; i < still.ticks.size(); ++i) {
    ASSERT_EQ(changed.ticks[i].sent.force, still.ticks[i].sent.force) << i;
    ASSERT_EQ(changed.ticks[i].time_s, still.ticks[i].time_s) << i;
    ASSERT_EQ(changed.ticks[i].result_age_ticks, still.ticks[i].result_age_ticks) << i;
  }
}

TEST(PlanSwitch, AnotherProfileOrDeviceFadesIn) {
  const Ran still = run({});
  for (const PlanTarget& to : {target(Profile::kPaper, false), target(Profile::kRefined, false, false)}) {
    // A stated law is every profile's; `corrected` never pulls.
    const Ran changed = run({{501, to}}, {}, [](Scene& scene) { scene.control.law_stated = true; });
    ASSERT_EQ(changed.ticks.size(), 1001u);
    EXPECT_EQ(changed.summary.plan_changes, 1u);
    std::size_t drop = 0;  // the first tick that differs: the new plan's first answer has come
    while (drop < still.ticks.size() && changed.ticks[drop].sent.force == still.ticks[drop].sent.force)
      ++drop;
    EXPECT_GE(drop, 504u) << "asked for at tick 501, whose result is three ticks old";
    EXPECT_LE(drop, 510u);
    const double deep = still.ticks[drop].sent.force.z;
    ASSERT_GT(deep, 0.5);
    EXPECT_LE(changed.ticks[drop].sent.force.z, 0.02 * deep) << "from zero";
    EXPECT_GT(changed.ticks[drop + 50].sent.force.z, 0.3 * deep) << "half faded in";
    for (const TickRecord& tick : changed.ticks) ASSERT_GE(tick.sent.force.z, 0);
  }
}

/// `paper` without a law of its own runs with `printed`, which knows no spring; `refined`, gone over to, must
/// feel as if the run had begun in it. A stated law stays.
TEST(PlanSwitch, AnotherProfileBringsItsOwnLaw) {
  const auto ran = [](bool from_paper, bool stated) {
    return run({{10, target(from_paper ? Profile::kRefined : Profile::kPaper, false)}}, {},
               [=](Scene& scene) {
                 scene.response.profile = from_paper ? Profile::kPaper : Profile::kRefined;
                 scene.control.law = from_paper ? ForceLaw::kPrinted : ForceLaw::kCorrected;
                 scene.control.law_stated = stated;
               });
  };
  const Ran still = run({}), to_refined = ran(true, false), to_paper = ran(false, false),
            stated = ran(true, true);
  ASSERT_EQ(to_refined.summary.profile_changes.size(), 1u);
  EXPECT_EQ(to_refined.summary.profile_changes[0].profile, "refined");
  EXPECT_EQ(to_refined.summary.profile_changes[0].law, "corrected");
  EXPECT_GE(to_refined.summary.profile_changes[0].tick, 10);
  EXPECT_LT(to_refined.summary.profile_changes[0].tick, 20);
  ASSERT_EQ(to_paper.summary.profile_changes.size(), 1u);
  EXPECT_EQ(to_paper.summary.profile_changes[0].law, "printed");
  ASSERT_EQ(stated.summary.profile_changes.size(), 1u);
  EXPECT_EQ(stated.summary.profile_changes[0].law, "printed");
  EXPECT_EQ(stated.summary.law, "printed");
  std::size_t in_contact = 0;
  double furthest = 0;
  for (std::size_t i = 200; i < still.ticks.size(); ++i) {  // the gate has opened
    if (still.ticks[i].sent.force.z == 0) continue;
    ++in_contact;
    const auto off = [&](const Ran& other) {
      return glm::length(other.ticks[i].sent.force - still.ticks[i].sent.force);
    };
    // Not to the bit: how old results are is averaged from another tick on.
    ASSERT_LT(off(to_refined), 1e-3 * still.summary.force_max_N) << i;
    furthest = std::max(furthest, off(stated));
  }
  EXPECT_GT(in_contact, 200u);
  EXPECT_GT(furthest, 0.01 * still.summary.force_max_N) << "the laws differ here";
}

TEST(PlanSwitch, APlanThatCantBePreparedChangesNothing) {
  const Ran still = run({}), kept = run({{400, target(Profile::kPaper, true)}}, [](const Progress&) {
                               return Result<void>(Error{ErrorCode::kBadValue, "out of memory"});
                             });
  EXPECT_EQ(kept.by_other, 0);
  EXPECT_EQ(kept.summary.plan_changes, 0u);
  EXPECT_THAT(kept.summary.notes, testing::Contains(testing::HasSubstr("out of memory")));
  for (std::size_t i = 0; i < still.ticks.size(); ++i)
    ASSERT_EQ(kept.ticks[i].sent.force, still.ticks[i].sent.force) << i;
}

TEST(PlanSwitch, TheLoopTicksOnWhileAPlanIsPrepared) {
  LoadedScene scene = half_space_scene();
  scene.scene.start.position.z = -0.005;
  scene.scene.device.path.clear();
  Planned first;
  auto owned = std::make_unique<Planned>();
  Ticks ticks;
  std::atomic<bool> began{false}, stop{false};
  // The preparation ends only when the loop has done 200 ticks more; a loop that waited for it would stand
  // still for good.
  owned->on_prepare = [&](const Progress& progress) -> Result<void> {
    const int from = ticks.seen.load();
    began.store(true);
    while (ticks.seen.load() < from + 200) {
      if (!progress("waiting", 0)) return Error{ErrorCode::kInternal, "cancelled"};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return {};
  };
  Planned& other = *owned;
  PlanSwitch plans(scene.geometry, std::move(owned));
  other.on_query = [&](int n) {
    if (n == 50) stop.store(true);
    return Result<void>();
  };
  auto device = make_simulated_device(scene.scene.device, scene.scene.start, Vec3(0));
  SessionOptions options{.pace = Pace::kRealtime, .duration_s = 120, .stop = &stop};
  options.plans = &plans;
  options.changes = {{20, target(Profile::kRefined, true)}};
  const auto summary = run_session(scene, first, **device, options, &ticks);
  ASSERT_TRUE(summary) << summary.error().sentence;
  EXPECT_TRUE(began.load());
  EXPECT_GE(other.queries, 50);
  EXPECT_EQ(summary->plan_changes, 1u);
  EXPECT_GE(summary->ticks, 220u);
  EXPECT_EQ(summary->watchdog_ticks, 0u) << "the first back end went on answering";
}

}  // namespace
}  // namespace palpate
