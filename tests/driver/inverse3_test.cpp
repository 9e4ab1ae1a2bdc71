// The Haply Inverse3's driver against a stand-in for its maker's service.
#include "driver/inverse3/inverse3_device.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <glm/glm.hpp>
#include <numbers>
#include <thread>

#include "driver/device_list.h"
#include "driver/inverse3/message.h"
#include "tests/driver/inverse3_service.h"

namespace palpate::inverse3 {
namespace {

using namespace std::chrono_literals;

const Pose kStart{Vec3(0.5, 0.6, 0.7), Quat(1, 0, 0, 0)};
const Wrench kPush{Vec3(0, 0, 2), Vec3(0)};

/// The device at a service of its own, ticked by hand.
class Inverse3 : public testing::Test {
 protected:
  void open(WorkspaceSettings workspace = {}) {
    device = make_inverse3({.port = service.port(), .workspace = workspace}, kStart);
    const auto opened = device->open();
    ASSERT_TRUE(opened) << opened.error().sentence;
    ASSERT_TRUE(within(2s, [&] { return sample.state == DeviceState::kReady; }));
  }
  /// Ticks, pushing, until something holds; false: it didn't in that time.
  bool within(std::chrono::milliseconds limit, const std::function<bool()>& holds) {
    for (const auto end = std::chrono::steady_clock::now() + limit; std::chrono::steady_clock::now() < end;) {
      sample = device->read();
      device->write(push, Vec3(0));
      if (holds()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  Vec3 force() {
    return service.locked([](auto& m) { return m.force; });
  }

  fake::Inverse3Service service;
  std::unique_ptr<HapticDevice> device;
  DeviceSample sample;
  Wrench push = kPush;
};

TEST_F(Inverse3, TheToolStartsWhereTheSceneHasItAndGoesAsTheHandGoes) {
  open();
  EXPECT_EQ(sample.pose.position, kStart.position);
  service.locked([](auto& m) { m.cursor += Vec3(0.01, -0.02, 0.03); });
  EXPECT_TRUE(within(2s, [&] {
    return glm::length(sample.pose.position - kStart.position - Vec3(0.01, -0.02, 0.03)) < 1e-12;
  }));
}

TEST_F(Inverse3, AForceArrivesInTheArmsAxesAndNoLargerThanItsLimit) {
  WorkspaceSettings turned;
  turned.axes = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};  // the world's z is the arm's x
  open(turned);
  EXPECT_TRUE(within(2s, [&] { return force() == Vec3(2, 0, 0); }));
  push.force = Vec3(0, 0, 200);
  EXPECT_TRUE(within(2s, [&] { return force().x > 2; }));
  EXPECT_DOUBLE_EQ(force().x, device->capabilities().max_force_n);
  push.force = Vec3(0, 0, NAN);
  EXPECT_TRUE(within(2s, [&] { return force() == Vec3(0); }));
  EXPECT_EQ(service.locked([](auto& m) { return m.strange; }), 0u);
}

TEST_F(Inverse3, AnOlderServiceGetsForcesInItsOwnSpelling) {
  service.locked([](auto& m) { m.session_ids = false; });
  open();
  EXPECT_TRUE(within(2s, [&] { return force() == kPush.force; }));
}

TEST_F(Inverse3, TheToolTurnsAsTheGripTurnsFromWhereItWasTakenUp) {
  const double h = std::sqrt(0.5);
  service.locked([&](auto& m) { m.grip = Quat(h, h, 0, 0); });
  WorkspaceSettings turned;
  turned.axes = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
  open(turned);
  EXPECT_TRUE(device->capabilities().sensed[3]);
  EXPECT_EQ(sample.pose.rotation, kStart.rotation) << "whatever the hand holds then";
  const double half = 0.1;  // about the arm's z, which is the world's y
  service.locked([&](auto& m) { m.grip = Quat(std::cos(half), 0, 0, std::sin(half)) * Quat(h, h, 0, 0); });
  const Quat expected(std::cos(half), 0, std::sin(half), 0);
  EXPECT_TRUE(within(2s, [&] { return std::abs(glm::dot(sample.pose.rotation, expected)) > 1 - 1e-12; }));
}

TEST_F(Inverse3, AGripThatWasSilentIsTakenUpAnew) {
  open();
  service.locked([](auto& m) { m.grip_speaks = false; });
  const auto before = service.locked([](auto& m) { return m.forces; });
  ASSERT_TRUE(within(2s, [&] { return service.locked([](auto& m) { return m.forces; }) > before + 20; }));
  EXPECT_EQ(sample.state, DeviceState::kReady) << "the handle's place is known all the same";
  service.locked([](auto& m) {
    m.grip = Quat(0, 0, 1, 0);
    m.grip_speaks = true;
  });
  ASSERT_TRUE(within(2s, [&] { return service.locked([](auto& m) { return m.forces; }) > before + 60; }));
  EXPECT_EQ(sample.pose.rotation, kStart.rotation);
}

TEST_F(Inverse3, WithoutAGripTheToolKeepsItsRotation) {
  service.locked([](auto& m) { m.has_grip = false; });
  open();
  EXPECT_FALSE(device->capabilities().sensed[3]);
  EXPECT_EQ(sample.pose.rotation, kStart.rotation);
}

TEST_F(Inverse3, TheClutchLetsTheHandMoveWithoutTheToolAndWithoutForce) {
  open({.clutch_buttons = 1});
  ASSERT_TRUE(within(2s, [&] { return force() == kPush.force; }));
  service.locked([](auto& m) { m.a = true; });
  ASSERT_TRUE(within(2s, [&] { return sample.clutched && force() == Vec3(0); }));
  service.locked([](auto& m) {
    m.cursor += Vec3(0.05, 0, 0);
    m.grip = Quat(0, 1, 0, 0);
  });
  const auto before = service.locked([](auto& m) { return m.forces; });
  ASSERT_TRUE(within(2s, [&] { return service.locked([](auto& m) { return m.forces; }) > before + 20; }));
  service.locked([](auto& m) { m.a = false; });
  ASSERT_TRUE(within(2s, [&] { return !sample.clutched && force() == kPush.force; }));
  EXPECT_LT(glm::length(sample.pose.position - kStart.position), 1e-12);
  EXPECT_EQ(sample.pose.rotation, kStart.rotation);
}

TEST_F(Inverse3, ALoopThatFallsSilentLeavesTheArmWithoutForce) {
  open();
  ASSERT_TRUE(within(2s, [&] { return force() == kPush.force; }));
  for (int i = 0; i < 2000 && force() != Vec3(0); ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(force(), Vec3(0));
}

TEST_F(Inverse3, ClosingLeavesTheArmWithoutForce) {
  open();
  ASSERT_TRUE(within(2s, [&] { return force() == kPush.force; }));
  device->close();
  for (int i = 0; i < 2000 && force() != Vec3(0); ++i) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(force(), Vec3(0));
  EXPECT_EQ(device->read().state, DeviceState::kClosed);
}

/// What a user or a broken service does while the tool is pressed, and how it ends.
struct Fault {
  const char* name;
  std::function<void(fake::Inverse3Service&)> begin, end;
  DeviceState state;  ///< meanwhile
};

class Inverse3Faults : public Inverse3, public testing::WithParamInterface<int> {};

const std::vector<Fault>& faults() {
  using Service = fake::Inverse3Service;
  static const std::vector<Fault> all{
      {"unplugged", [](Service& s) { s.locked([](auto& m) { m.plugged = false; }); },
       [](Service& s) { s.locked([](auto& m) { m.plugged = true; }); }, DeviceState::kOpening},
      {"service_stopped", [](Service& s) { s.stop(); }, [](Service& s) { s.start(); }, DeviceState::kOpening},
      {"silent", [](Service& s) { s.locked([](auto& m) { m.silent = true; }); },
       [](Service& s) { s.locked([](auto& m) { m.silent = false; }); }, DeviceState::kOpening},
      {"no_json", [](Service& s) { s.locked([](auto& m) { m.garbage = "{\"inverse3\": [{"; }); },
       [](Service& s) { s.locked([](auto& m) { m.garbage.clear(); }); }, DeviceState::kOpening},
      {"other_json", [](Service& s) { s.locked([](auto& m) { m.garbage = "[1, 2, {\"inverse3\": 3}]"; }); },
       [](Service& s) { s.locked([](auto& m) { m.garbage.clear(); }); }, DeviceState::kOpening},
      {"no_number",
       [](Service& s) {
         s.locked([](auto& m) {
           m.garbage = R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":1e999,"y":0}}}]})";
         });
       },
       [](Service& s) { s.locked([](auto& m) { m.garbage.clear(); }); }, DeviceState::kOpening},
      {"not_ready", [](Service& s) { s.locked([](auto& m) { m.ready = false; }); },
       [](Service& s) { s.locked([](auto& m) { m.ready = true; }); }, DeviceState::kHoming},
  };
  return all;
}

TEST_P(Inverse3Faults, EndsWithoutForceSaysWhatToDoAndComesBack) {
  const Fault& fault = faults()[static_cast<std::size_t>(GetParam())];
  open();
  ASSERT_TRUE(within(2s, [&] { return force() == kPush.force; }));
  fault.begin(service);
  ASSERT_TRUE(within(3s, [&] { return sample.state == fault.state; }));
  EXPECT_STRNE(device->guidance(), "");
  fault.end(service);
  // The hand has moved meanwhile; the tool goes on from where it was.
  service.locked([](auto& m) { m.cursor += Vec3(0.02, 0, 0); });
  push.force = Vec3(0);
  service.locked([](auto& m) { m.force = Vec3(9); });
  ASSERT_TRUE(within(5s, [&] { return sample.state == DeviceState::kReady; }));
  EXPECT_TRUE(within(2s, [&] { return force() == Vec3(0); })) << "nothing of before the fault is sent on";
  push = kPush;
  EXPECT_TRUE(within(2s, [&] { return force() == kPush.force; }));
}

INSTANTIATE_TEST_SUITE_P(While, Inverse3Faults, testing::Range(0, 7), [](const auto& param) {
  return std::string(faults()[static_cast<std::size_t>(param.param)].name);
});

TEST_F(Inverse3, WithoutServiceOrArmOpeningSaysSo) {
  const auto refused = [&](const char* why) {
    device = make_inverse3({.port = service.port()}, kStart);
    const auto opened = device->open();
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().code, ErrorCode::kNoDevice);
    EXPECT_NE(opened.error().sentence.find(why), std::string::npos) << opened.error().sentence;
  };
  service.locked([](auto& m) { m.plugged = false; });
  refused("knows of no Inverse3");
  service.locked([](auto& m) { m.wordless = true; });
  refused("nothing answers at 127.0.0.1:");
  service.stop();
  refused("nothing answers at 127.0.0.1:");
}

TEST(Inverse3Message, AnInventoryWithoutDevicesOrOfAnotherKindIsRefused) {
  for (const char* text : {"", "null", "[]", "{}", R"({"inverse3":{}})", R"({"inverse3":[]})",
                           R"({"inverse3":[{}]})", R"({"inverse3":[{"device_id":5}]})", "{\"inverse3\":"})
    EXPECT_FALSE(read_inventory(text)) << text;
}

TEST(Inverse3Message, AStateWithoutASoundQuaternionHasNoOrientation) {
  Session session{.arm = "1", .grip = "2", .grip_list = "verse_grip"};
  const std::string head =
      R"({"inverse3":[{"device_id":"1","state":{"cursor_position":{"x":1,"y":2,"z":3}}}],)"
      R"("verse_grip":[{"device_id":"2","state":{"button":true,"orientation":)";
  const auto state = read_state(head + R"({"w":0,"x":0,"y":0,"z":1}}}]})", session);
  ASSERT_TRUE(state);
  EXPECT_EQ(state->cursor, Vec3(1, 2, 3));
  EXPECT_EQ(state->buttons, 1u);
  EXPECT_EQ(state->orientation, Quat(0, 0, 0, 1));
  for (const char* none : {R"({"w":0,"x":0,"y":0,"z":0}}}]})", R"({"w":0,"x":0,"y":0}}}]})", R"(7}}]})",
                           R"({"w":1,"x":1,"y":0,"z":0}}}]})"}) {
    const auto other = read_state(head + none, session);
    ASSERT_TRUE(other) << none;
    EXPECT_FALSE(other->orientation) << none;
  }
}

TEST(Inverse3Name, ItsPortStandsBehindAColon) {
  for (const char* name : {"inverse3", "inverse3:10002"})
    EXPECT_TRUE(make_haptic_device(name, {}, {}, Vec3(0))) << name;
  for (const char* name :
       {"inverse3:", "inverse3:0", "inverse3:65536", "inverse3:-1", "inverse3:1x", "inverse34"})
    EXPECT_FALSE(make_haptic_device(name, {}, {}, Vec3(0))) << name;
}

}  // namespace
}  // namespace palpate::inverse3
