#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "driver/rate_control.h"
#include "driver/spacemouse/report.h"
#include "driver/workspace.h"

namespace palpate {
namespace {

std::vector<std::uint8_t> report(std::uint8_t number, const std::vector<int>& values) {
  std::vector<std::uint8_t> bytes{number};
  for (const int value : values) {
    bytes.push_back(static_cast<std::uint8_t>(value & 0xFF));
    bytes.push_back(static_cast<std::uint8_t>((value >> 8) & 0xFF));
  }
  return bytes;
}

TEST(SpaceMouseReport, OlderModelsSpeakInTwoReports) {
  spacemouse::Cap cap;
  ASSERT_TRUE(spacemouse::take(report(1, {350, -350, 7}), cap));
  ASSERT_TRUE(spacemouse::take(report(2, {-1, 2, -3}), cap));
  EXPECT_EQ(cap.axes, (std::array<std::int16_t, 6>{350, -350, 7, -1, 2, -3}));
}

TEST(SpaceMouseReport, NewerModelsSpeakInOne) {
  spacemouse::Cap cap;
  ASSERT_TRUE(spacemouse::take(report(1, {1, 2, 3, -4, -5, -6}), cap));
  EXPECT_EQ(cap.axes, (std::array<std::int16_t, 6>{1, 2, 3, -4, -5, -6}));
}

TEST(SpaceMouseReport, DeflectionsBeyondFullAreCut) {
  spacemouse::Cap cap;
  ASSERT_TRUE(spacemouse::take(report(1, {32767, -32768, 351}), cap));
  EXPECT_EQ(cap.axes[0], 350);
  EXPECT_EQ(cap.axes[1], -350);
  EXPECT_EQ(cap.axes[2], 350);
}

TEST(SpaceMouseReport, ButtonsAreBits) {
  spacemouse::Cap cap;
  const std::vector<std::uint8_t> two{3, 0x02}, many{3, 0x01, 0x80, 0x00, 0x10};
  ASSERT_TRUE(spacemouse::take(two, cap));
  EXPECT_EQ(cap.buttons, 2U);
  ASSERT_TRUE(spacemouse::take(many, cap));
  EXPECT_EQ(cap.buttons, 0x10008001U);
}

TEST(SpaceMouseReport, WhatIsNoReportChangesNothing) {
  spacemouse::Cap cap;
  ASSERT_TRUE(spacemouse::take(report(1, {9, 9, 9}), cap));
  for (const std::vector<std::uint8_t>& bytes :
       {std::vector<std::uint8_t>{}, {1}, {1, 2, 3, 4, 5, 6}, {2, 0}, {17, 1, 1, 1, 1, 1, 1}, {3}})
    EXPECT_FALSE(spacemouse::take(bytes, cap));
  EXPECT_EQ(cap.axes, (std::array<std::int16_t, 6>{9, 9, 9, 0, 0, 0}));
}

TEST(RateControl, RestsInTheDeadZoneAndNeverOutrunsItsLimits) {
  RateControl rate({}, Pose{});
  for (int i = 0; i < 1000; ++i) rate.step({0.08, -0.08, NAN, 0.05, 0, INFINITY * 0});
  EXPECT_EQ(rate.pose().position, Vec3(0));
  EXPECT_EQ(rate.pose().rotation, Quat(1, 0, 0, 0));
  for (int i = 0; i < 1000; ++i)
    rate.step({5, 0, 0, 0, 0, 1});                  // more than full deflection is full deflection
  EXPECT_NEAR(rate.pose().position.x, 0.1, 1e-12);  // 0.1 m/s for a second
  // 1 rad in a second, each step short by (0.5 mrad)³·2/3.
  EXPECT_NEAR(2 * std::atan2(rate.pose().rotation.z, rate.pose().rotation.w), 1.0, 1e-7);
  EXPECT_NEAR(glm::length(rate.pose().rotation), 1, 1e-15);
}

TEST(Workspace, TheToolStartsWhereTheSceneSaysAndFollowsScaledAndTurned) {
  WorkspaceSettings settings;
  settings.scale = 2;
  settings.axes = {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};  // device z is world x, x is y, y is z
  Pose start;
  start.position = Vec3(1, 2, 3);
  Workspace workspace(settings, start);
  EXPECT_EQ(workspace.position({0.5, 0.5, 0.5}, 0), Vec3(1, 2, 3));
  EXPECT_EQ(workspace.position({0.5, 0.5, 0.75}, 0), Vec3(1.5, 2, 3));
  EXPECT_EQ(workspace.device({1, 0, 0}), Vec3(0, 0, 1));
  EXPECT_EQ(workspace.world(workspace.device({1, 2, 3})), Vec3(1, 2, 3));
}

TEST(Workspace, TheClutchLetsTheHandBeginAnew) {
  WorkspaceSettings settings;
  settings.clutch_buttons = 4;
  Workspace workspace(settings, Pose{});
  workspace.position({0, 0, 0}, 0);
  EXPECT_EQ(workspace.position({1, 0, 0}, 0), Vec3(1, 0, 0));
  EXPECT_EQ(workspace.position({0, 0, 0}, 4), Vec3(1, 0, 0));
  EXPECT_EQ(workspace.position({-1, 0, 0}, 4), Vec3(1, 0, 0));
  EXPECT_EQ(workspace.position({0, 0, 0}, 0), Vec3(2, 0, 0));
  workspace.release();  // homed anew: the device's zero may be anywhere
  EXPECT_EQ(workspace.position({7, 7, 7}, 0), Vec3(2, 0, 0));
}

TEST(Workspace, AnOffsetPutsTheMiddleOfTheDeviceThere) {
  WorkspaceSettings settings;
  settings.scale = 2;
  settings.offset_m = Vec3(10, 0, 0);
  settings.clutch_buttons = 1;
  Workspace workspace(settings, Pose{});
  EXPECT_EQ(workspace.position({0.5, 0, 0}, 0), Vec3(11, 0, 0));
  EXPECT_EQ(workspace.position({0, 0, 0}, 1), Vec3(11, 0, 0));
  EXPECT_EQ(workspace.position({0.5, 0, 0}, 0), Vec3(12, 0, 0))
      << "the clutch takes the hand elsewhere all the same";
  workspace.release();
  EXPECT_EQ(workspace.position({0.5, 0, 0}, 0), Vec3(11, 0, 0)) << "homed anew: back to what the scene says";
}

}  // namespace
}  // namespace palpate
