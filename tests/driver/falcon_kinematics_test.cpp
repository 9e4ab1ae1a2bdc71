#include "driver/falcon/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>
#include <numbers>
#include <random>

namespace palpate::falcon {
namespace {

/// The cube in which a hand moves the grip, m, as far as the legs reach it.
Vec3 random_position(std::mt19937_64& random) {
  std::uniform_real_distribution<double> side(-0.05, 0.05);
  return Vec3(side(random), side(random), 0.125 + side(random));
}

TEST(FalconKinematics, FourPublishedPositionsComeOut) {
  struct Case {
    Encoders encoders;
    Vec3 mm;
  };
  for (const Case& c :
       {Case{{0, 0, 0}, {0, 0, 134.6024}}, Case{{500, 500, 500}, {0, 0, 156.8605}},
        Case{{-500, -500, -500}, {0, 0, 110.7545}}, Case{{661, 731, 766}, {0.1628, 4.3707, 164.9907}}}) {
    const auto position = position_of_angles(angles_of_encoders(c.encoders), kCentre);
    ASSERT_TRUE(position);
    // They are printed with four decimals of a millimetre.
    EXPECT_LE(glm::length(*position * 1e3 - c.mm), 0.5e-4 * std::sqrt(3.0)) << c.encoders[0];
    const auto angles = angles_of_position(*position);
    ASSERT_TRUE(angles);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(counts_of_angle((*angles)[i]), c.encoders[i], 1e-9);
  }
}

TEST(FalconKinematics, ForwardAndInverseCancelOverTheWorkspace) {
  std::mt19937_64 random(1);
  int reached = 0;
  double worst = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const Vec3 wanted = random_position(random);
    const auto angles = angles_of_position(wanted);
    if (!angles) continue;
    ++reached;
    const auto found = position_of_angles(*angles, kCentre);  // the farthest start there is
    ASSERT_TRUE(found) << wanted.x << ' ' << wanted.y << ' ' << wanted.z;
    worst = std::max(worst, glm::length(*found - wanted));
  }
  EXPECT_LE(worst, 1e-12);
  EXPECT_GT(reached, 900'000) << "the cube is mostly within reach";
}

TEST(FalconKinematics, AnglesOfTheWorkspaceArePossibleAndAWholeTurnMoreIsNot) {
  std::mt19937_64 random(3);
  double least = 10, largest = -10;
  for (int i = 0; i < 100'000; ++i) {
    const auto angles = angles_of_position(random_position(random) *
                                           Vec3(0.8, 0.8, 1));  // 80 mm wide: more than the device's 75 mm
    if (!angles) continue;
    for (const double angle : *angles) least = std::min(least, angle), largest = std::max(largest, angle);
    EXPECT_TRUE(possible(*angles));
  }
  const double turn = 2 * std::numbers::pi;
  EXPECT_FALSE(possible({0.6 + turn, 0.6, 0.6}));
  EXPECT_FALSE(possible({0.6, 0.6 - turn, 0.6}));
  EXPECT_FALSE(possible({0.6, 0.6, NAN}));
  std::printf("angles from %.1f to %.1f degrees\n", least * 360 / turn, largest * 360 / turn);
}

TEST(FalconKinematics, PowerAtTheMotorsIsPowerAtTheGrip) {
  // τ·dθ = F·dx for a small step; both sides' step by central differences of the inverse, which leaves an
  // error of the order (h/size)² ≈ 1e-10 of the power.
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  constexpr double h = 1e-6;
  int judged = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 position = random_position(random) * Vec3(0.7, 0.7, 1.0);
    const Vec3 force(normal(random), normal(random), normal(random));
    const Vec3 way = glm::normalize(Vec3(normal(random), normal(random), normal(random)));
    const auto angles = angles_of_position(position), before = angles_of_position(position - h * way),
               after = angles_of_position(position + h * way);
    if (!angles || !before || !after) continue;
    const auto torques = torques_of_force(*angles, position, force);
    ASSERT_TRUE(torques);
    double at_motors = 0, size = 0;
    for (std::size_t leg = 0; leg < 3; ++leg) {
      const double turn = ((*after)[leg] - (*before)[leg]) / (2 * h);
      at_motors += (*torques)[leg] * turn;
      size += std::abs((*torques)[leg] * turn);
    }
    // Near full stretch the inverse bends without bound; the test's own differences are then worth nothing.
    bool stretched = false;
    for (std::size_t leg = 0; leg < 3; ++leg)
      stretched = stretched || std::abs((*after)[leg] - 2 * (*angles)[leg] + (*before)[leg]) > 2e-4 * h;
    if (stretched) continue;
    ++judged;
    EXPECT_NEAR(at_motors, glm::dot(force, way), 1e-9 * std::max(1.0, size));
  }
  EXPECT_GT(judged, 10000) << "most positions are far enough from full stretch";
}

TEST(FalconKinematics, OutOfReachIsSaid) {
  EXPECT_FALSE(angles_of_position({0, 0, 0.5}));
  EXPECT_FALSE(angles_of_position({0.5, 0, 0.1}));
  EXPECT_FALSE(angles_of_position({NAN, 0, 0.1}));
  EXPECT_FALSE(position_of_angles({NAN, 0, 0}, kCentre));
  EXPECT_FALSE(position_of_angles({0, 0, 0}, Vec3(INFINITY)));
}

}  // namespace
}  // namespace palpate::falcon
