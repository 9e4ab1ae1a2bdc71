// Parts of the server by themselves, where the order of events decides and a whole server meets that order
// only now and then.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>
#include <vector>

#include "service/loop/control_loop.h"
#include "service/server/queries/batch_queue.h"
#include "service/server/queries/turns.h"
#include "service/server/sessions/pausable_device.h"
#include "service/server/sessions/telemetry.h"
#include "tests/service/half_space.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// Answers with more ids than a batch is read ahead, and says when it is asked.
class LongAnswers final : public HalfSpace {
 public:
  explicit LongAnswers(std::function<void()> asked) : asked_(std::move(asked)) {}
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    asked_();
    auto done = HalfSpace::query(pose, ignored, out);
    out.cst.resize(300'000);
    std::iota(out.cst.begin(), out.cst.end(), 1'000'000u);  // eight bytes each as text
    return done;
  }

 private:
  std::function<void()> asked_;
};

// A client that went while the slice was answered that would have set its batch aside was never counted out:
// 256 of them, and no query was taken any more.
TEST(BatchQueue, AClientThatGoesWhileItsPosesAreAnsweredLeavesNothing) {
  const Parts parts;
  const ServerLimits limits;
  Metrics metrics;
  Log log;
  SceneStore store(parts, "cpu", limits, metrics, log);
  std::shared_ptr<BodySource> client;  // touched by the queue's thread alone
  const auto scene = std::make_shared<HostedScene>();
  scene->loaded = half_space_scene();
  scene->backend =
      std::make_unique<LongAnswers>([&] { client.reset(); });  // it is there from the second slice on
  BatchQueue queue(store, limits, metrics);
  BatchRequest request;
  request.scene = std::make_shared<SceneLease>(scene, std::make_shared<SceneLease::Count>(), false);
  request.poses.resize(1000);
  queue.add(std::move(request), [&](HttpResponse response) {
    client = response.source;
    client->next([](const Chunk&) {});
  });
  const auto end = std::chrono::steady_clock::now() + 60s;  // a hang is a failure
  while (metrics.batches_now > 0 && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(metrics.batches_now, 0u) << "batches under way, and nobody waits for one";
}

/// Ready at once. Moves so far along x with every write, m, and keeps the wrench it was last sent.
class Hand final : public HapticDevice {
 public:
  explicit Hand(double step_m) : step_m_(step_m) {}
  std::string name() const override { return "hand"; }
  DeviceCapabilities capabilities() const override {
    return {.sensed = {true, true, true}, .actuated = {true, true, true}, .max_force_n = 8};
  }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read() noexcept override {
    DeviceSample sample;
    sample.pose.position.x = x_;
    sample.state = DeviceState::kReady;
    return sample;
  }
  void write(const Wrench& wrench, const Vec3&) noexcept override {
    felt = wrench;
    x_ += step_m_;
  }
  Wrench felt;

 private:
  double step_m_, x_ = 0;
};

// "paused" was told beside poses from before the pause, which a recording thread that got no processor had
// not told yet.
TEST(Turns, SeveralBatchesAndALoopAreServedOneAtATime) {
  constexpr int kEnough = 100;  // turns of each, however late the system starts a thread
  Turns turns;
  std::array<std::atomic<int>, 3> done{};
  std::atomic<int> inside{0}, worst{0};
  const auto end = std::chrono::steady_clock::now() + 60s;  // one who is forgotten is a failure, no hang
  const auto all_served = [&] {
    return std::ranges::all_of(done, [](const std::atomic<int>& turns_had) { return turns_had >= kEnough; });
  };
  std::vector<std::thread> threads;  // each always wants more
  threads.reserve(done.size());
  for (std::atomic<int>& mine : done)
    threads.emplace_back([&, kind = &mine == &done[0] ? TurnGuard::Kind::kLoop : TurnGuard::Kind::kBatch] {
      while (!all_served() && std::chrono::steady_clock::now() < end) {
        const TurnGuard turn(turns, kind);
        const int now = ++inside;
        if (now > worst) worst = now;
        std::this_thread::yield();
        ++mine;
        --inside;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(all_served());
  EXPECT_EQ(worst, 1);
}

TEST(Telemetry, IsPausedFromTheTickOnThatStandsStill) {
  Hand sliding(1e-3);
  PausableDevice pausable(sliding, true);
  SafeDevice device(pausable, {});
  ASSERT_TRUE(device.open());
  ControlTick tick(device, {}, Vec3(0), {});
  auto record = [&, i = std::int64_t{0}]() mutable {
    tick.sense(i++);
    return tick.act(nullptr);
  };
  std::vector<TickRecord> late;  // not told yet
  late.push_back(record());
  late.push_back(record());
  pausable.set_paused(true);
  for (int i = 0; i < 3; ++i) late.push_back(record());
  pausable.set_paused(false);
  late.push_back(record());
  late.push_back(record());

  Metrics metrics;
  Telemetry telemetry(metrics, nullptr);
  const auto viewer = telemetry.attach([] {});
  std::vector<std::pair<bool, double>> told;  // paused, x
  std::uint64_t seen = 0;
  for (const TickRecord& row : late) {
    while (!telemetry.newest() ||
           telemetry.newest()->seq == seen) {  // a message is made of one tick in 16 ms
      ASSERT_TRUE(telemetry.on_tick(row));
      std::this_thread::sleep_for(1ms);
    }
    seen = telemetry.newest()->seq;
    const auto message = nlohmann::json::parse("{" + telemetry.newest()->json.substr(1));
    told.emplace_back(message["paused"], message["pose"][0]);
    const bool bit = (static_cast<unsigned char>(telemetry.newest()->binary[6]) & 8) != 0;
    EXPECT_EQ(bit, told.back().first);
  }
  const std::vector<std::pair<bool, double>> expected = {{false, 0},    {false, 0.001}, {true, 0.002},
                                                         {true, 0.002}, {true, 0.002},  {false, 0.002},
                                                         {false, 0.003}};
  EXPECT_EQ(told, expected);
}

// It was that of the newest message, a sixtieth of a second old, and stayed so when the session was over.
TEST(Telemetry, KnowsTheLastTick) {
  Metrics metrics;
  Telemetry telemetry(metrics, nullptr);
  for (std::int64_t i = 0; i < 3; ++i) {
    TickRecord tick;
    tick.tick = i;
    ASSERT_TRUE(telemetry.on_tick(tick));
    EXPECT_EQ(telemetry.last_tick().tick, i);
  }
}

// The loop's record said what would have been sent.
TEST(PausableDevice, OfMetalFeelsAndTellsNoForceAndFadesInAgain) {
  Hand hand(0);
  PausableDevice pausable(hand, false);
  SafeDevice device(pausable, {.fade_in_ticks = 10, .watchdog_ticks = 0});
  ASSERT_TRUE(device.open());
  ControlTick tick(device, {.kind = LawKind::kHold}, Vec3(0), {});
  LawResult pressed;
  pressed.wrench.force = {0, 0, 2};
  pressed.contact = true;
  std::int64_t at = 0;
  const auto force = [&] {
    tick.sense(at);
    pressed.tick = at++;
    const TickRecord& record = tick.act(&pressed);
    EXPECT_EQ(record.sent.force.z, hand.felt.force.z);
    EXPECT_EQ(record.response.force.z, 2);
    return record.sent.force.z;
  };
  for (int i = 0; i < 20; ++i) force();
  EXPECT_EQ(force(), 2);
  pausable.set_paused(true);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(force(), 0);
  pausable.set_paused(false);
  for (int i = 1; i <= 10; ++i) EXPECT_NEAR(force(), 0.2 * i, 1e-12);  // rounding of the gain's sum
}

}  // namespace
}  // namespace palpate
