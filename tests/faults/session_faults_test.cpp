// The device side of failures on the Vulkan device: a session on the simulated haptic device, which must see
// zero force in time.
#include <gmock/gmock.h>

#include <atomic>

#include "compute/native/native_backend.h"
#include "driver/simulated_device.h"
#include "service/loop/session.h"
#include "service/loop/steady_backend.h"
#include "tests/faults/fault_scene.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Call = GpuFault::Call;

constexpr int kWatchdogTicks = 20,
              kFadeTicks = 20;  // the defaults of a scene, and SafetySettings::fade_out_ticks

/// The simulated device, counting what reaches it.
class CountingDevice final : public HapticDevice {
 public:
  explicit CountingDevice(const LoadedScene& scene) {
    auto made = make_simulated_device(scene.scene.device, scene.scene.start, Vec3(0));
    if (!made) throw std::runtime_error(made.error().sentence);
    device_ = std::move(made).value();
  }
  std::string name() const override { return "simulated"; }
  double motion_s() const override { return device_->motion_s(); }
  DeviceCapabilities capabilities() const override { return device_->capabilities(); }
  Result<void> open() override { return device_->open(); }
  void close() noexcept override {
    closed_at_zero = last == Vec3(0);
    device_->close();
  }
  DeviceSample read() noexcept override { return device_->read(); }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    last = wrench.force;
    if (last != Vec3(0)) ++(failed ? pushes_after : pushes_before);
    if (pushes_after > enough) stop = true;
    device_->write(wrench, gc);
  }

  Vec3 last{9};
  bool closed_at_zero = false;
  std::atomic<bool> failed = false;
  int enough = 1 << 30;  ///< ticks with a force after `failed`, which end the run
  std::atomic<bool> stop = false;
  std::atomic<int> pushes_before = 0, pushes_after = 0;  ///< ticks with a force, before and after `failed`

 private:
  std::unique_ptr<HapticDevice> device_;
};

/// The Vulkan back end, whose device is lost at the query after `healthy` ones with a contact.
class LosingBackend final : public CollisionBackend {
 public:
  LosingBackend(int healthy, CountingDevice& device) : healthy_(healthy), device_(device) {
    GpuOptions options;
    options.fault = fault_;
    auto made = make_gpu_backend(options);
    if (!made) throw std::runtime_error(made.error().sentence);
    gpu_ = std::move(*made);
  }
  Result<void> prepare(const SceneGeometry& geometry, const Plan& plan, const Progress& progress) override {
    return gpu_->prepare(geometry, plan, progress);
  }
  Result<void> query(const LatticePose& pose, const Ignored* ignored, Contacts& out) override {
    if (healthy_-- <= 0) {  // a pose that touches nothing submits nothing and loses nothing
      fault_->call = Call::kSubmit;
      auto lost = gpu_->query(pose, ignored, out);
      if (!lost) device_.failed = true;
      return lost;
    }
    return gpu_->query(pose, ignored, out);
  }
  Result<VoxelPartition> partition(bool tool) const override { return gpu_->partition(tool); }
  bool has_internal_voxels() const override { return gpu_->has_internal_voxels(); }
  std::string name() const override { return gpu_->name(); }
  std::string device() const override { return gpu_->device(); }
  std::uint64_t memory_bytes() const override { return gpu_->memory_bytes(); }

 private:
  int healthy_;
  CountingDevice& device_;
  std::shared_ptr<GpuFault> fault_ = std::make_shared<GpuFault>();
  std::unique_ptr<CollisionBackend> gpu_;
};

/// A ball held 3.5 mm deep over the edge of a block.
LoadedScene pressed() {
  auto made = ball_on_edge();
  LoadedScene scene;
  scene.geometry = std::move(made->geometry);
  scene.scene.control.fade_in_ms = 0;
  scene.scene.start.position = Vec3(0.039, 0.001, 0.0065);
  scene.scene.device.actuated = {true, true, true, false, false, false};
  return scene;
}

class LostInMidRun : public testing::TestWithParam<Pace> {};
INSTANTIATE_TEST_SUITE_P(BothPaces, LostInMidRun, testing::Values(Pace::kRealtime, Pace::kAsap),
                         [](const auto& tested) {
                           return tested.param == Pace::kAsap ? "asap" : "realtime";
                         });

TEST_P(LostInMidRun, WithoutASpareTheRunEndsWithZeroForceAndTheSummarySaysWhy) {
  const LoadedScene scene = pressed();
  CountingDevice device(scene);
  SteadyBackend backend(std::make_unique<LosingBackend>(30, device), nullptr);
  ASSERT_TRUE(backend.prepare(scene.geometry, {}, {}));
  const auto summary = run_session(scene, backend, device, {.pace = GetParam(), .duration_s = 60}, nullptr);
  ASSERT_TRUE(summary) << summary.error().sentence;
  ASSERT_TRUE(summary->failure);
  EXPECT_THAT(summary->failure->sentence,
              HasSubstr("the device was lost; the run has ended with zero force"));
  EXPECT_EQ(summary->backend, "gpu");
  EXPECT_LT(summary->ticks, 60'000u);
  EXPECT_GT(device.pushes_before, 0);
  EXPECT_LE(device.pushes_after, kWatchdogTicks + kFadeTicks) << "the watchdog is the last to act";
  EXPECT_TRUE(device.closed_at_zero);
}

TEST_P(LostInMidRun, WithASpareTheNativeEngineGoesOnAndTheSummarySaysSo) {
  const LoadedScene scene = pressed();
  CountingDevice device(scene);
  SteadyBackend backend(std::make_unique<LosingBackend>(30, device), [] { return make_native_backend(); });
  ASSERT_TRUE(backend.prepare(scene.geometry, {}, {}));
  device.enough = 2 * (kWatchdogTicks + kFadeTicks);  // more than was on its way when the device was lost
  const auto summary = run_session(scene, backend, device,
                                   {.pace = GetParam(), .duration_s = 120, .stop = &device.stop}, nullptr);
  ASSERT_TRUE(summary) << summary.error().sentence;
  EXPECT_FALSE(summary->failure);
  EXPECT_EQ(summary->backend, "cpu");
  EXPECT_THAT(summary->notes, Contains(HasSubstr("the device was lost")));
  EXPECT_THAT(summary->notes, Contains(HasSubstr("the engine cpu answers instead")));
  EXPECT_TRUE(summary->stopped) << "force is back";
  EXPECT_TRUE(device.closed_at_zero);
}

TEST(TooSmallInMidRun, GrowsAndGivesTheSameForcesAsEnoughRoom) {
  const LoadedScene scene = pressed();
  struct Forces : RunObserver {
    std::vector<Vec3> sent;
    Result<void> on_tick(const TickRecord& tick) override {
      sent.push_back(tick.sent.force);
      return {};
    }
  } roomy, grown;
  for (const bool small : {false, true}) {
    GpuOptions options;
    if (small) options.first_capacity = {{"pairs", 3}, {"samples", 3}};
    auto gpu = make_gpu_backend(options);
    ASSERT_TRUE(gpu) << gpu.error().sentence;
    SteadyBackend backend(std::move(*gpu), nullptr);
    ASSERT_TRUE(backend.prepare(scene.geometry, {}, {}));
    CountingDevice device(scene);
    const auto summary = run_session(scene, backend, device, {.pace = Pace::kAsap, .duration_s = 0.1},
                                     small ? &grown : &roomy);
    ASSERT_TRUE(summary);
    EXPECT_FALSE(summary->failure);
    for (const char* name : {"pairs"})  // of several at once the first is named
      EXPECT_EQ(std::any_of(summary->notes.begin(), summary->notes.end(),
                            [&](const std::string& note) {
                              return note.find("too little room for " + std::string(name) + ":") !=
                                     std::string::npos;
                            }),
                small)
          << name;
  }
  EXPECT_EQ(roomy.sent, grown.sent);
  EXPECT_EQ(roomy.sent.size(), 100u);
}

}  // namespace
}  // namespace palpate
