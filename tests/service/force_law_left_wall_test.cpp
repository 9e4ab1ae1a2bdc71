// A wall that the tool has just left.
#include <gtest/gtest.h>

#include "tests/service/force_law_fixture.h"

namespace palpate {
namespace {

/// A mass dropped on a wall by its own weight of 1 N, from 1 mm; results c ticks old and c apart.
AxisLoop drop(double stiffness, int delay) {
  AxisLoop loop = pressed(steady(delay), delay, stiffness);
  loop.contact = linear_wall(stiffness, 0);
  loop.load_n = -1;
  loop.start_x = 1e-3;
  loop.settle_ticks = 0;
  return loop;
}

TEST(LeftWall, LetsABounceDieOutAtTheStiffnessThatIsStableInContact) {
  for (const int delay : {1, 2, 5, 10}) {
    const AxisLoop::Outcome outcome = drop(1900, delay).run(20000);
    EXPECT_TRUE(AxisLoop::stable(outcome, 1e-6))
        << delay << ": " << outcome.early << " " << outcome.late << " m";
    EXPECT_GE(outcome.least_force_n, 0);
  }
}

TEST(LeftWall, IsThereAtOnceWhenTheHandComesBack) {
  ForceLawState state(steady(1));
  const LawResult touch = wall(0, -2e-3), free = wall(20, 3e-3);
  for (int i = 0; i < 20; ++i) state.step(at(i, -2e-3 + 2.5e-4 * i), i == 0 ? &touch : nullptr);
  EXPECT_EQ(state.step(at(21, 3e-3), &free).force, Vec3(0));
  for (int i = 22; i < 60; ++i) {
    const double x = 3e-3 - 2e-4 * (i - 22);
    EXPECT_NEAR(state.step(at(i, x), nullptr).force.x, std::max(0.0, -kK * x), 1e-9) << i;
  }
}

TEST(LeftWall, IsGivenUpWhereAResultFindsNothingOrTheHandHasGoneAlongItOrItIsOld) {
  const auto force_after = [](const LawResult& second, int tick, const Vec3& gc) {
    ForceLawState state(law(kC, 1));
    const LawResult touch = wall(0, -2e-3);
    state.step(at(0, -2e-3), &touch);
    for (int i = 1; i < tick; ++i) state.step({i, Vec3(2e-3, gc.y * i / tick, 0)}, nullptr);
    state.step({tick, second.gc}, &second);
    return state.step({tick + 1, gc}, nullptr).force.x;
  };
  const LawResult near = wall(20, 2e-3);
  EXPECT_GT(force_after(near, 21, Vec3(-1e-3, 0, 0)), 1) << "kept";
  LawResult nothing = near;
  nothing.gc.x = -1e-3;
  EXPECT_EQ(force_after(nothing, 21, Vec3(-1e-3, 0, 0)), 0);
  LawResult along = near;
  along.gc.y = 6e-3;
  EXPECT_EQ(force_after(along, 21, Vec3(-1e-3, 6e-3, 0)), 0);
  LawResult old = near;
  old.tick = 260;
  EXPECT_EQ(force_after(old, 261, Vec3(-1e-3, 0, 0)), 0);
}

TEST(LeftWall, CountsOnceWhenAResultHasItAgain) {
  ForceLawState state(law(kC, 1));
  const LawResult touch = wall(0, -2e-3), free = wall(20, 2e-3), again = wall(40, -1e-3);
  state.step(at(0, -2e-3), &touch);
  state.step(at(21, 2e-3), &free);
  EXPECT_NEAR(state.step(at(41, -1e-3), &again).force.x, 2, 1e-12);
}

}  // namespace
}  // namespace palpate
