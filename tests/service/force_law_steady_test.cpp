// A force that never jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "driver/limits.h"
#include "model/lattice/rotation.h"
#include "tests/service/force_law_fixture.h"

namespace palpate {
namespace {

TEST(SteadyForce, NeverChangesByMoreInATickThanTheHandsWayAndTheRateAllowWhateverResultsCome) {
  // In a tick: (κ + 2K) times the way of the contact points, plus 0.1 N. κ sums over a result's planes;
  // levers reach 0.1 m.
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto vector = [&](double reach) {
    return reach * Vec3(2 * unit(random) - 1, 2 * unit(random) - 1, 2 * unit(random) - 1);
  };
  double largest_jump = 0;
  for (int run = 0; run < 60; ++run) {
    ForceLawState state(steady(run % 8));
    const double speed = run % 3 == 0 ? 0 : 1e-3 * unit(random);  // m a tick
    LawPose pose;
    Vec3 before(0), told(0);
    for (int i = 0; i < 600; ++i) {
      const Vec3 moved = vector(speed), turned = vector(speed);
      pose = {i, pose.gc + moved, glm::normalize(rotation_by(turned) * pose.rotation)};
      LawResult result;
      result.tick = i - 1 - static_cast<int>(12 * unit(random));
      result.gc = pose.gc + vector(1e-3);
      result.rotation = pose.rotation;
      result.plane_count = static_cast<std::uint32_t>(5 * unit(random));
      for (std::uint32_t p = 0; p < result.plane_count; ++p)
        result.planes[p] = {glm::normalize(vector(1) + Vec3(0, 0, 1.1)), vector(0.05), 30 * unit(random),
                            500 + 1500 * unit(random)};
      const bool comes = unit(random) < 0.3;
      if (comes) {
        const Vec3 now = pushed(result, pose.gc, pose.rotation).force;
        largest_jump = std::max(largest_jump, length(now - told));
        told = now;
      }
      const Vec3 force = state.step(pose, comes ? &result : nullptr).force;
      const double way = length(moved) + 0.1 * length(turned);
      ASSERT_LE(length(force - before), (4 * 2000 + 2 * kK) * way + kRate * 1e-3 + 1e-9) << run << " " << i;
      before = force;
    }
  }
  EXPECT_GT(largest_jump, 50) << "the results themselves jumped by that many newtons";
}

TEST(SteadyForce, GoesOverToAnotherSetOfAreasAtTheRateWhileTheHandRests) {
  // Two pads of 10 N become one: 20 N → 10 N in 100 ticks; and splits again.
  ForceLawState state(steady(3));
  LawResult two = wall(0, -5e-3), one = wall(10, -5e-3);
  two.planes[1] = two.planes[0];
  two.planes[1].lever = Vec3(0, 0.05, 0);
  two.plane_count = 2;
  double before = 0;
  for (int i = 0; i < 800; ++i) {
    two.tick = one.tick = i;
    const double force = state.step(at(i, -5e-3), i % 3 != 0            ? nullptr
                                                  : i < 300 || i >= 500 ? &two
                                                                        : &one)
                             .force.x;
    EXPECT_LE(std::abs(force - before), 0.1 + 1e-9) << i;
    if (i == 299 || i == 799) {
      EXPECT_NEAR(force, 20, 1e-9);
    }
    // 51 N·mm of torque at 0.05 m goes with the force: the lever's share sets the pace, 100 ticks of force.
    if (i == 450) {
      EXPECT_NEAR(force, 10, 1e-9);
    }
    before = force;
  }
}

TEST(SteadyForce, LetsAWallBuildUpInFrontOfAFastHand) {
  // 1 m/s into 2000 N/m, results 5 ticks late: 25 ms on, the force is the wall's, and within 10 ms it is half
  // of it.
  ForceLawState state(steady(5));
  LawResult pending;
  for (int i = 0; i < 60; ++i) {
    const double x = 0.02 - 1e-3 * i;
    const LawResult arrived = pending;
    if (i % 5 == 0) pending = wall(i, x);
    const double force = state.step(at(i, x), i % 5 == 0 && arrived.tick >= 0 ? &arrived : nullptr).force.x;
    if (i >= 32) {
      EXPECT_GE(force, 0.5 * kK * -x) << i;
    }
    if (i >= 45) {
      EXPECT_NEAR(force, kK * -x, 1e-6) << i;
    }
  }
}

TEST(SteadyForce, IsThatOfTheLawWithoutTheLimitWhereAreasDoNotChange) {
  // A smooth press: nothing to hold back, the same bits.
  ForceLawState limited(steady(5)), free(law(kC, 5));
  LawResult pending;
  for (int i = 0; i < 2000; ++i) {
    const double x = -2e-3 * (1 - std::cos(0.003 * i));
    const LawResult arrived = pending;
    if (i % 5 == 0) pending = wall(i, x);
    const LawResult* fresh = i % 5 == 0 && arrived.tick >= 0 ? &arrived : nullptr;
    ASSERT_EQ(limited.step(at(i, x), fresh).force, free.step(at(i, x), fresh).force) << i;
  }
}

TEST(SteadyForce, LetsWhatIsLeftBehindGiveWayButNotGrow) {
  // The contact has ended; the hand presses on into the empty place.
  ForceLawState state(steady(1));
  const LawResult touch = wall(0, -5e-3), free = wall(200, 1.0);
  for (int i = 0; i < 200; ++i) state.step(at(i, -5e-3), i == 0 ? &touch : nullptr);
  double before = 10;
  for (int i = 200; i < 300; ++i) {
    const double force = state.step(at(i, -5e-3 - 1e-5 * (i - 200)), i == 200 ? &free : nullptr).force.x;
    EXPECT_LE(force, before);
    before = force;
  }
  EXPECT_EQ(before, 0);
}

TEST(SteadyForce, KeepsTheStableStiffness) {
  // 1 mm of preload: reached within the loop's 200 ticks of settling, 0.1 N each.
  for (const int delay : {1, 5, 10})
    EXPECT_NEAR(critical_stiffness(steady(delay), delay, 1, 1e-3) / 2001, 1, 0.01) << delay;
}

}  // namespace
}  // namespace palpate
