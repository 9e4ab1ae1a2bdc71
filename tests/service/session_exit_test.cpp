// Every way out of a run ends with zero force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "service/loop/session.h"
#include "tests/service/half_space.h"
#include "tests/service/watched_run.h"

namespace palpate {
namespace {

using testing::HasSubstr;

class SessionExit : public testing::TestWithParam<Pace> {
 protected:
  SessionExit() : scene(half_space_scene()) {
    scene.scene.start.position.z = -0.005;
    scene.scene.device.path.resize(1);
    scene.scene.device.path[0].pose = scene.scene.start;
  }
  Result<SessionSummary> run(WatchedDevice& device, RunObserver* observer = nullptr,
                             const std::atomic<bool>* stop = nullptr) {
    return run_session(scene, backend, device, {.pace = GetParam(), .duration_s = duration_s, .stop = stop},
                       observer);
  }
  LoadedScene scene;
  HalfSpace backend;
  double duration_s = 60;  // of which a failing run uses a fraction
};
INSTANTIATE_TEST_SUITE_P(BothPaces, SessionExit, testing::Values(Pace::kRealtime, Pace::kAsap),
                         [](const auto& tested) {
                           return tested.param == Pace::kAsap ? "asap" : "realtime";
                         });

TEST_P(SessionExit, IsAtZeroAfterTheLastTick) {
  WatchedDevice device(scene);
  duration_s = 0.1;
  ASSERT_TRUE(run(device));
  EXPECT_GT(device.strongest, 0.5);
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(SessionExit, IsAtZeroWhenStopped) {
  WatchedDevice device(scene);
  std::atomic<bool> stop = false;
  Watcher watcher;
  watcher.stop_in_contact = &stop;
  const auto summary = run(device, &watcher, &stop);
  ASSERT_TRUE(summary);
  EXPECT_TRUE(summary->stopped);
  EXPECT_GT(device.writes, 0);
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(SessionExit, IsAtZeroWhenTheBackEndFails) {
  WatchedDevice device(scene);
  backend.on_query = [](int n) {
    return n < 20 ? Result<void>() : Result<void>(Error{ErrorCode::kInternal, "the Vulkan device was lost"});
  };
  const auto summary = run(device);
  ASSERT_TRUE(summary && summary->failure);
  EXPECT_EQ(summary->failure->sentence, "the Vulkan device was lost; the run has ended with zero force");
  EXPECT_GT(device.strongest, 0.5);
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(SessionExit, IsAtZeroWhenTheBackEndThrows) {
  WatchedDevice device(scene);
  backend.on_query = [](int n) -> Result<void> {
    if (n == 20) throw std::runtime_error("bad shader");
    return {};
  };
  const auto summary = run(device);
  ASSERT_TRUE(summary && summary->failure);
  EXPECT_THAT(summary->failure->sentence, HasSubstr("bad shader"));
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(SessionExit, IsAtZeroWhenTheDeviceFails) {
  WatchedDevice device(scene);
  device.fault_after = 50;
  const auto summary = run(device);
  ASSERT_TRUE(summary && summary->failure);
  EXPECT_THAT(summary->failure->sentence, HasSubstr("reported a fault"));
  EXPECT_GT(device.strongest, 0.5);
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(SessionExit, IsAtZeroWhenTheRecordingFails) {
  for (const bool throws : {false, true}) {
    WatchedDevice device(scene);
    Watcher watcher;
    (throws ? watcher.throw_at : watcher.fail_at) = 30;
    const auto summary = run(device, &watcher);
    ASSERT_TRUE(summary && summary->failure);
    EXPECT_THAT(summary->failure->sentence, HasSubstr(throws ? "out of ink" : "the disk is full"));
    EXPECT_TRUE(device.closed_at_zero);
  }
}

TEST_P(SessionExit, GivesNoForceForATruncatedFrame) {
  WatchedDevice device(scene);
  class Truncating : public HalfSpace {
    Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
      auto done = HalfSpace::query(pose, ignored, out);
      out.truncated = true, out.truncated_capacity = "pairs";
      return done;
    }
  } truncating;
  const auto summary =
      run_session(scene, truncating, device, {.pace = GetParam(), .duration_s = 0.05}, nullptr);
  ASSERT_TRUE(summary);
  EXPECT_EQ(device.strongest, 0);
  EXPECT_THAT(summary->notes, testing::Contains(HasSubstr("pairs")));
}

}  // namespace
}  // namespace palpate
