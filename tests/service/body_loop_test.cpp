// Six degrees of freedom: the simulated device, its safety wrapper, the shipped law and the virtual coupling
// in one loop.
#include "service/loop/body_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "driver/limits.h"
#include "driver/simulated_device.h"
#include "model/lattice/rotation.h"
#include "service/bench/stability/stability_bodies.h"
#include "tests/driver/allocation_count.h"

namespace palpate {
namespace {

Result<std::unique_ptr<HapticDevice>> simulated(const DeviceSettings& settings, const Pose& start) {
  return make_simulated_device(settings, start, Vec3(0));
}

const BodyCase& body(const std::string& name) {
  static const std::vector<BodyCase> all = body_cases();
  for (const BodyCase& one : all)
    if (one.name == name) return one;
  throw std::runtime_error("no body is called " + name);
}

// --- The highest stable stiffness of a whole tool ---

TEST(BodyStability, IsWhatTheLinearLimitOfAllMotionsAtOnceAllows) {
  constexpr int kDelay = 10;
  for (const BodyCase& what : body_cases()) {
    const double held = body_theory(what.device, what.pads, 14.5e-3),
                 ours = body_theory(what.device, what.pads, 0);
    const double hold = highest_stable_body(simulated, what, LawKind::kHold, kDelay),
                 corrected = highest_stable_body(simulated, what, LawKind::kCorrected, kDelay);
    std::printf("%-34s hold %6.0f N/m (theory %6.0f), corrected %6.0f (%6.0f)\n", what.name.c_str(), hold,
                held, corrected, ours);
    // Bounds from below: no motion is less damped than the worst one. Half a percent of bisection, and a run
    // of 20 s counts as dying out only if it has lost 5 %.
    EXPECT_GE(corrected, 0.98 * ours) << what.name;
    EXPECT_GE(hold, std::max(10.0, 0.94 * held))
        << what.name;  // optimistic where the lag is long and the mass small (docs/CONTROL.md)
    // From above, where the worst motion is one that the body has by itself; gc at the end of a lever has
    // none of its own.
    if (what.name.find("lever") == std::string::npos) {
      EXPECT_LE(corrected, 1.06 * ours) << what.name;
    }
    EXPECT_GE(corrected, 0.9 * highest_stable_body(simulated, what, LawKind::kHold, 0))
        << what.name << ": ten milliseconds cost less than a tenth";
  }
}

TEST(BodyStability, OfABouncingPlateOutlivesTheDelay) {
  const double late = highest_stable_body(simulated, body("plate"), LawKind::kCorrected, 10, true);
  std::printf("plate, dropped on four pads: %.0f N/m\n", late);
  EXPECT_GE(late, body_theory(body("plate").device, body("plate").pads,
                              0));  // above it a bounce may die out even so
}

// --- The virtual coupling ---

TEST(VirtualCoupling, MakesAnyWallStableOnceItsSpringIsBelowTheDevicesLimit) {
  // b / (T/2) = 2000 N/m, and 10 N·m/rad. 10^5 N/m is as far as is looked.
  const CouplingSettings soft{1800, 8};
  for (const int delay : {1, 10})
    EXPECT_EQ(highest_stable_body(simulated, body("plate"), LawKind::kCorrected, delay, false, soft), 1e5)
        << delay;
  // Beyond that the load of eight pads topples the peg about its own axis, which no pad holds.
  EXPECT_GE(highest_stable_body(simulated, body("peg in hole"), LawKind::kCorrected, 10, false, soft), 10000);
}

TEST(VirtualCoupling, IsASpringInSeriesWithTheWall) {
  // Without it four pads are stable up to `limit`; with it, when 4 K k / (4 K + k) is.
  const double limit = 4 * highest_stable_body(simulated, body("plate"), LawKind::kCorrected, 10);
  for (const double k : {4000.0, 10000.0}) {
    const double found =
        4 * highest_stable_body(simulated, body("plate"), LawKind::kCorrected, 10, false, {k, 0});
    EXPECT_NEAR(found / (limit * k / (k - limit)), 1, 0.04)
        << k;  // two bisections of half a percent, times k / (k − limit)
  }
}

/// A law that has gone over to some walls around the origin.
ForceLawState among_walls(std::mt19937& random, double stiffness) {
  std::uniform_real_distribution<double> unit(-1, 1);
  ForceLawState law({.stiffness_n_per_m = stiffness, .transitions = 1});
  LawResult result;
  result.tick = 0;
  result.contact = true;
  result.plane_count = 5;
  for (std::uint32_t i = 0; i < result.plane_count; ++i)
    result.planes[i] = {
        .normal = glm::normalize(Vec3(unit(random), unit(random), unit(random)) + Vec3(0, 0, 1e-6)),
        .lever = 0.05 * Vec3(unit(random), unit(random), unit(random)),
        .force = stiffness * 2e-3 * unit(random),
        .stiffness = stiffness * (0.6 + 0.4 * unit(random))};
  law.step({.tick = 1}, &result);
  for (int i = 2; i < 5; ++i) law.step({.tick = i}, nullptr);
  return law;
}

TEST(VirtualCoupling, BalancesPushAndSpringAndIsNoStifferThanItWhateverTheWalls) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> unit(-1, 1);
  const CouplingSettings settings{1000, 2};
  const auto energy = [&](const Vec3& f, const Vec3& t) {
    return glm::dot(f, f) / settings.stiffness_n_per_m + glm::dot(t, t) / settings.stiffness_nm_per_rad;
  };
  for (int round = 0; round < 200; ++round) {
    const ForceLawState law = among_walls(random, std::pow(10, 4.5 + 1.5 * unit(random)));
    VirtualCoupling coupling(settings);
    Vec3 at(0), force_before(0), torque_before(0), at_before(0);
    const std::size_t allocated = allocations_of_this_thread();
    for (int i = 0; i < 100; ++i) {
      at += 2e-4 * Vec3(unit(random), unit(random), unit(random));
      const LawPose tool = coupling.follow(law, {.tick = 5 + i, .gc = at});
      Wrench push;
      StiffnessMatrix slope;
      law.feel(tool.gc, tool.rotation, push, slope);
      const Vec3 apart = tool.gc - at, turned = rotation_vector(tool.rotation);
      if (i < 19) continue;  // it comes out of what it begins in, no faster than kFastest
      // 1 mN: planes turn with the tool a little, which Newton's slope leaves out.
      ASSERT_LT(glm::length(push.force - settings.stiffness_n_per_m * apart), 1e-3) << round << " " << i;
      ASSERT_LT(glm::length(push.torque - settings.stiffness_nm_per_rad * turned), 1e-4) << round << " " << i;
      if (i > 20) {
        const Vec3 way = at - at_before;
        ASSERT_LE(std::sqrt(energy(push.force - force_before, push.torque - torque_before)),
                  std::sqrt(settings.stiffness_n_per_m * glm::dot(way, way)) + 1e-3)
            << round << " " << i;
      }
      force_before = push.force, torque_before = push.torque, at_before = at;
    }
    ASSERT_EQ(allocations_of_this_thread(), allocated);
  }
}

TEST(VirtualCoupling, LetsTheForceJumpWithNoResultWhateverItIs) {
  // |F(i) − F(i−1)| ≤ 3 K · way + 0.1 N, turns by their way at the springs' arm, and so for torque: results
  // of walls a thousand times as stiff, there and gone again.
  std::mt19937 random(41);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&](double reach) { return reach * Vec3(unit(random), unit(random), unit(random)); };
  constexpr double kSpring = 2000, kArm = 0.03;
  const CouplingSettings settings{kSpring, kSpring * kArm * kArm};
  double largest = 0, deepest = 0;
  for (int run = 0; run < 40; ++run) {
    ForceLawState law({.transitions = 1 + run % 8});
    VirtualCoupling coupling(settings, 100);
    const double speed = run % 3 == 0 ? 0 : 5e-4 * (1 + unit(random));  // m a tick
    LawPose device;
    Wrench before;
    for (int i = 0; i < 600; ++i) {
      const Vec3 moved = vector(speed), turned = vector(10 * speed);
      device = {i, device.gc + moved, glm::normalize(rotation_by(turned) * device.rotation)};
      const LawPose tool = coupling.follow(law, device);
      LawResult result;
      result.tick = i - 1;
      result.gc = tool.gc + vector(1e-3);
      result.rotation = tool.rotation;
      result.plane_count = static_cast<std::uint32_t>(32 * (1 + unit(random)));
      for (std::uint32_t p = 0; p < result.plane_count; ++p)
        result.planes[p] = {glm::normalize(vector(1) + Vec3(0, 0, 0.5)), vector(0.05), 500 * unit(random),
                            std::pow(10, 5 + unit(random))};
      const bool comes = unit(random) < -0.4;
      law.step(tool, comes ? &result : nullptr);
      const Wrench felt = coupling.force({});
      const double step =
          std::hypot(length(felt.force - before.force), length(felt.torque - before.torque) / kArm);
      ASSERT_LE(step, 3 * kSpring * std::hypot(length(moved), kArm * length(turned)) + 0.1 + 1e-6)
          << run << " " << i;
      largest = std::max(largest, length(pushed(result, tool.gc, tool.rotation).force));
      deepest = std::max(deepest, length(felt.force));
      before = felt;
    }
  }
  EXPECT_GT(largest, 5000) << "what the results said";
  EXPECT_GT(deepest, 2) << "and something of it came through";
}

TEST(VirtualCoupling, LeavesTheToolWhereTheDeviceIsInFreeSpace) {
  const ForceLawState law({});
  VirtualCoupling coupling({1000, 2});
  const LawPose device{.tick = 3, .gc = Vec3(1, 2, 3), .rotation = rotation_by(Vec3(0.3, -1, 2))};
  const LawPose tool = coupling.follow(law, device);
  EXPECT_EQ(tool.gc, device.gc);
  EXPECT_NEAR(std::abs(glm::dot(tool.rotation, device.rotation)), 1, 1e-15);
}

TEST(VirtualCoupling, ComesOutOfAWallNoFasterThanAHandGoes) {
  std::mt19937 random(37);
  const ForceLawState law = among_walls(random, 1e6);
  VirtualCoupling coupling({1, 1e-3});
  Vec3 before(0);
  for (int i = 0; i < 50; ++i) {
    const LawPose tool = coupling.follow(law, {.tick = 5 + i});
    ASSERT_LE(glm::length(tool.gc - before), VirtualCoupling::kFastest * (1 + 1e-9));
    before = tool.gc;
  }
}

}  // namespace
}  // namespace palpate
