#include "service/loop/force_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>

#include "driver/limits.h"
#include "model/lattice/rotation.h"
#include "tests/driver/allocation_count.h"
#include "tests/service/force_law_fixture.h"

namespace palpate {
namespace {

static_assert(std::is_trivially_copyable_v<LawResult> && std::is_trivially_copyable_v<ForceLawState>);

/// Lowest force along the wall's normal while the newest result has contact: 5 mm deep, then a retreat at
/// `speed` m/s, results 10 ms old and 10 ms apart.
double lowest_force_in_retreat(const ForceLawSettings& settings, double speed) {
  ForceLawState state(settings);
  LawResult pending;
  double lowest = 1e9;
  bool contact = true;
  for (int i = 0; i < 200; ++i) {
    const double x = -5e-3 + (i > 100 ? speed * 1e-3 * (i - 100) : 0);
    const LawResult arrived = pending;
    const bool fresh = i % 10 == 0;
    if (fresh) pending = wall(i, x);
    if (fresh && arrived.tick >= 0) contact = arrived.contact;
    const double force = state.step(at(i, x), fresh && arrived.tick >= 0 ? &arrived : nullptr).force.x;
    if (i > 50 && contact) lowest = std::min(lowest, force);
  }
  return lowest;
}

TEST(ForceLaw, PrintedTurnsAQuickRetreatIntoAPull) {
  // K·(2 mm − 0.3 m/s · 19 ms) and K·(5 mm − 1 m/s · 19 ms): a result is 19 ticks old before the next one
  // comes.
  EXPECT_NEAR(lowest_force_in_retreat(law(kP, 1, true), 0.3), -7.4, 1e-6);
  EXPECT_NEAR(lowest_force_in_retreat(law(kP, 1, true), 1.0), -28, 1e-6);
}

TEST(ForceLaw, CorrectedNeverPullsInAQuickRetreat) {
  for (const int n : {0, 1, 3, 5, 10, 20})
    for (const double speed : {0.1, 0.3, 1.0, 3.0})
      EXPECT_GE(lowest_force_in_retreat(law(kC, n), speed), 0) << n << " " << speed;
}

TEST(ForceLaw, CorrectedNeverPullsWhateverResultsComeWhen) {
  const Vec3 normal(0.6, 0, 0.8);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int run = 0; run < 50; ++run) {
    ForceLawState state(law(kC, run % 8));
    Vec3 gc(0);
    Quat rotation(1, 0, 0, 0);
    for (int i = 0; i < 400; ++i) {
      gc += 2e-3 * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
      rotation = glm::normalize(
          rotation_by(0.02 * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5)) * rotation);
      LawResult result;
      result.tick = i - 1 - static_cast<int>(12 * unit(random));  // sometimes older than one that has come
      result.gc = gc + 1e-2 * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5);
      result.rotation = rotation;
      result.plane_count = static_cast<std::uint32_t>(3 * unit(random));
      for (std::uint32_t p = 0; p < result.plane_count; ++p)
        result.planes[p] = {normal, 0.1 * Vec3(unit(random), unit(random), unit(random)), 10 * unit(random),
                            2000 * unit(random)};
      const Wrench force = state.step({i, gc, rotation}, unit(random) < 0.4 ? &result : nullptr);
      ASSERT_GE(glm::dot(force.force, normal), 0);
      ASSERT_LT(length(glm::cross(force.force, normal)), 1e-9) << "force along the areas' normal only";
    }
  }
}

TEST(ForceLaw, PrintedDragsInFreeSpaceAndCorrectedDoesNot) {
  // 2000 N/m × 0.1 m/s × 5 ms = 1 N, no contact anywhere.
  ForceLawState printed(law(kP, 1, true)), corrected(law(kC, 1));
  double drag = 0;
  for (int i = 0; i <= 5; ++i) {
    const LawResult free = wall(0, 1.0);
    const LawPose pose = at(i, 1.0 + 1e-4 * i);
    drag = printed.step(pose, &free).force.x;
    EXPECT_EQ(corrected.step(pose, &free).force, Vec3(0));
  }
  EXPECT_NEAR(drag, -1, 1e-9);
}

TEST(ForceLaw, CorrectedIsEquationFiveWithTheHandsMotionPutBackOnOneLinearContact) {
  // P = M(i−1) − K(U(i) − U(i−1)); ΔM = (M_r − K(U(i) − U(i−j)) − P)/n; n steps of ΔM. Coded directly, for n
  // ≤ c.
  constexpr int kDelay = 6, kN = 4;
  ForceLawState state(law(kC, kN));
  double direct = 0, delta = 0, last_x = 0;
  int steps = 0;
  LawResult pending;
  for (int i = 0; i < 500; ++i) {
    // Deep enough never to come out, and a wall that isn't where it was: results jump by up to 1 N.
    const double x = -0.1 + 1e-3 * std::sin(0.05 * i);
    const LawResult arrived = pending;
    const bool fresh = i % kDelay == 0 && arrived.tick >= 0;
    if (i % kDelay == 0) {
      pending = wall(i, x);
      pending.planes[0].force += std::sin(1.0 * i);
    }
    const double force = state.step(at(i, x), fresh ? &arrived : nullptr).force.x;
    const double carried = direct - kK * (x - last_x);
    if (fresh) {
      delta = (arrived.planes[0].force - kK * (x - arrived.gc.x) - carried) / kN;
      steps = kN;
    }
    direct = carried + (steps > 0 ? delta : 0);
    steps = std::max(0, steps - 1);
    last_x = x;
    // The first ramp comes from nothing, whose force doesn't follow the motion.
    if (i >= 2 * kDelay) {
      ASSERT_NEAR(force, direct, 1e-9) << i;
    } else {
      direct = force;
    }
  }
}

TEST(ForceLaw, CorrectedReachesALateResultInNTicksAndNeverPassesIt) {
  ForceLawState corrected(law(kC, 5)), printed(law(kP, 5));
  const LawResult free = wall(0, 1.0), touch = wall(10, -5e-3);  // 10 N
  double highest_printed = 0, before = 0;
  for (int i = 0; i < 80; ++i) {
    const LawResult* fresh = i == 0 ? &free : i == 20 ? &touch : nullptr;
    LawPose pose = at(i, i < 10 ? 1.0 : -5e-3);
    const double force = corrected.step(pose, fresh).force.x;
    if (i < 20) {
      EXPECT_EQ(force, 0);
    } else if (i < 24) {
      EXPECT_NEAR(force, 10.0 * (i - 19) / 5, 1e-12);
    } else {
      EXPECT_NEAR(force, 10, 1e-12);
    }
    EXPECT_GE(force, before);
    before = force;
    if (i >= 20)
      highest_printed = std::max(highest_printed, printed.step(pose, i == 20 ? &touch : nullptr).force.x);
  }
  EXPECT_NEAR(highest_printed, 120, 1e-9)
      << "as printed, 2 N more at each of the 60 ticks until a result comes";
}

TEST(ForceLaw, CorrectedEndsAContactInNTicksExactly) {
  ForceLawState state(law(kC, 4));
  const LawResult touch = wall(0, -5e-3);
  LawResult free = wall(10, 1.0);
  free.gc.x = -5e-3;  // nothing where the wall was
  for (int i = 0; i < 10; ++i) state.step(at(i, -5e-3), &touch);
  for (int i = 10; i < 14; ++i)
    EXPECT_NEAR(state.step(at(i, -5e-3), &free).force.x, 10.0 * (13 - i) / 4, 1e-12);
  EXPECT_EQ(state.step(at(14, -5e-3), nullptr).force, Vec3(0));
}

TEST(ForceLaw, CorrectedFadesFromOneSetOfAreasToAnotherWithoutAJump) {
  ForceLawState state(law(kC, 5));
  LawResult a = wall(0, -5e-3), b = wall(10, -5e-3);
  b.planes[0].normal = Vec3(0, 1, 0);
  b.planes[1] = {.normal = Vec3(0, 0, 1), .force = 4, .stiffness = kK};
  b.plane_count = 2;
  for (int i = 0; i < 10; ++i) state.step(at(i, -5e-3), &a);
  Vec3 before = state.step(at(10, -5e-3), nullptr).force;
  for (int i = 11; i < 20; ++i) {
    const Vec3 force = state.step(at(i, -5e-3), &b).force;
    EXPECT_LE(length(force - before), length(Vec3(-10, 10, 4)) / 5 + 1e-12);
    before = force;
  }
  EXPECT_NEAR(length(before - Vec3(0, 10, 4)), 0, 1e-12);
}

TEST(ForceLaw, IgnoresARepeatedAndAnOlderResult) {
  for (const LawKind kind : {kH, kP, kC}) {
    ForceLawState once(law(kind, 3)), often(law(kind, 3));
    const LawResult first = wall(5, -4e-3), older = wall(4, -9e-3);
    for (int i = 6; i < 30; ++i) {
      const double x = -4e-3 + 1e-5 * i;
      const Wrench a = once.step(at(i, x), i == 6 ? &first : nullptr);
      const Wrench b = often.step(at(i, x), i % 3 == 2 ? &older : &first);
      EXPECT_EQ(a.force, b.force);
    }
  }
}

TEST(ForceLaw, KeepsItsPlanesWhenResultsStayAway) {
  // Nothing drifts: 1000 ticks later the force is that of the plane at the present pose. (The watchdog takes
  // it away.)
  ForceLawState state(law(kC, 3));
  const LawResult touch = wall(0, -5e-3);
  state.step(at(3, -5e-3), &touch);
  for (int i = 4; i < 1000; ++i) state.step(at(i, -5e-3), nullptr);
  EXPECT_NEAR(state.step(at(1000, -6e-3), nullptr).force.x, 12, 1e-12);
}

TEST(ForceLaw, ExtrapolatesRotationByTheShortWay) {
  // A lever of 10 cm about y and a turn of 1 mrad: the contact comes out by 0.1 mm, 0.2 N at κ = 2000 N/m.
  LawResult result = wall(0, -5e-3);
  result.planes[0].lever = Vec3(0, 0.1, 0);
  result.rotation = rotation_by({0.3, 0.2, 0.1});
  const Quat turned = rotation_by({0, 1e-3, 0}) * result.rotation;
  for (const Quat& same : {turned, -turned}) {  // q and −q are one rotation
    ForceLawState state(law(kC, 1));
    const Wrench force = state.step({1, result.gc, same}, &result);
    EXPECT_NEAR(force.force.x, 9.8, 1e-9);
    EXPECT_NEAR(force.torque.y, 0.98, 1e-9);
  }
}

TEST(ForceLaw, PrintedIgnoresRotationAndPullsSideways) {
  ForceLawState state(law(kP, 1, true));
  LawResult result = wall(0, -5e-3);
  const Wrench force = state.step({1, result.gc + Vec3(0, 1e-3, 0), rotation_by({0.1, 0, 0})}, &result);
  EXPECT_NEAR(force.force.x, 10, 1e-12);
  EXPECT_NEAR(force.force.y, -2, 1e-12) << "a tangential pull: scalar K";
}

TEST(ForceLaw, AutoTransitionsFollowTheAgeOfResults) {
  ForceLawState state(law(kC, 0));
  for (int i = 0; i < 100; ++i) {
    const LawResult result = wall(i, -1e-3);
    state.step(at(i + 7, -1e-3), &result);
  }
  EXPECT_EQ(state.transitions(), 7);
  for (int i = 200; i < 300; ++i) {
    const LawResult result = wall(i, -1e-3);
    state.step(at(i + 3, -1e-3), &result);
  }
  EXPECT_EQ(state.transitions(), 3);
}

TEST(ForceLaw, SharesAlwaysAddUpToOneWhileNChanges) {
  // A motionless contact must feel the same through any change of n.
  ForceLawState state(law(kC, 0));
  std::mt19937 random(3);
  std::int64_t tick = 0;
  for (int i = 0; i < 2000; ++i) {
    const LawResult result = wall(tick, -5e-3);
    tick += 1 + static_cast<std::int64_t>(random() % 90);
    const double force = state.step(at(tick, -5e-3), &result).force.x;
    if (i > 300) {
      ASSERT_NEAR(force, 10, 1e-9);
    }
    state.step(at(tick + 1, -5e-3), nullptr);
    tick += 1;
  }
}

TEST(ForceLaw, GivesNoForceBeforeTheFirstResult) {
  for (const LawKind kind : {kH, kP, kC}) {
    ForceLawState state(law(kind, 3));
    for (int i = 0; i < 10; ++i) EXPECT_EQ(state.step(at(i, -1e-2 * i), nullptr).force, Vec3(0));
  }
}

TEST(ForceLaw, DoesNotAllocate) {
  ForceLawState state(law(kC, 5));
  const std::size_t before = allocations_of_this_thread();
  for (int i = 0; i < 100; ++i) {
    const LawResult result = wall(i, -1e-3);
    state.step(at(i + 2, -1e-3), &result);
  }
  EXPECT_EQ(allocations_of_this_thread(), before);
}

// --- What can't be trusted ---

TEST(ForceLaw, IgnoresAResultThatIsNotFiniteOrFromTheFuture) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const LawKind kind : {kH, kP, kC}) {
    for (int fault = 0; fault < 7; ++fault) {
      ForceLawState state(law(kind, 3));
      LawResult good = wall(0, -5e-3), bad = wall(5, -5e-3);
      for (int i = 0; i < 5; ++i) state.step(at(i, -5e-3), &good);
      if (fault == 0) bad.gc.y = nan;
      if (fault == 1) bad.planes[0].force = inf;
      if (fault == 2) bad.planes[0].stiffness = -inf;
      if (fault == 3) bad.wrench.torque.z = nan;
      if (fault == 4) bad.plane_count = kMaxLawPlanes + 1;
      if (fault == 5) bad.rotation.w = 7;
      if (fault == 6) bad.tick = 7;
      const Wrench with = state.step(at(6, -5e-3), &bad);
      EXPECT_FALSE(state.took_fresh()) << fault;
      EXPECT_TRUE(finite(with));
    }
  }
}

TEST(ForceLaw, ForgetsEverythingWhenThePoseJumps) {
  ForceLawState state(law(kC, 1));
  LawResult touch = wall(0, -5e-3);
  EXPECT_GT(state.step(at(1, -5e-3), &touch).force.x, 9);
  EXPECT_EQ(state.step(at(2, -1.0), nullptr).force, Vec3(0)) << "a device that homes: not 2000 N";
  EXPECT_TRUE(state.jumped());
  touch.tick = 1;
  EXPECT_EQ(state.step(at(3, -1.0), &touch).force, Vec3(0)) << "a result for the pose before the jump";
  touch = wall(3, -1.0);
  EXPECT_GT(state.step(at(4, -1.0), &touch).force.x, 0);
}

}  // namespace
}  // namespace palpate
