// A device of one's own on palpate's control loop: implement HapticDevice, hand it to run_session().
#include <cpu_ref/ref_backend.h>
#include <model/generate.h>
#include <service/loop/session.h>

#include <cstdio>
#include <utility>

using namespace palpate;

/// Stands in for a closed SDK: a stylus in a hand that pulls it along a path with 300 N/m.
class MyDevice : public HapticDevice {
 public:
  explicit MyDevice(std::vector<PathPoint> path) : path_(std::move(path)), pose_(path_.front().pose) {}
  std::string name() const override { return "mine"; }
  DeviceCapabilities capabilities() const override {
    return {
        .sensed = {true, true, true}, .actuated = {true, true, true}, .max_force_n = 3.3, .max_torque_nm = 0};
  }
  // Find it, load firmware; an Error says in one sentence what failed.
  Result<void> open() override { return {}; }
  void close() noexcept override {}        // motors off
  DeviceSample read() noexcept override {  // once a tick; never allocates, locks, throws or waits
    return {.pose = pose_, .time_ns = tick_ * 1'000'000, .state = DeviceState::kReady};
  }
  void write(const Wrench& wrench, const Vec3& /*gc*/) noexcept override {
    const Vec3 hand = path_[static_cast<std::size_t>(++tick_ / 20) % path_.size()].pose.position;
    pose_.position += 0.05 * (hand + wrench.force / 300.0 - pose_.position);
  }

 private:
  std::vector<PathPoint> path_;  // a point every 20 ms
  Pose pose_;
  std::int64_t tick_ = 0;
};

int main() {
  const auto failed = [](const Error& error) {
    return std::fprintf(stderr, "%s\n", error.sentence.c_str()), 1;
  };
  auto made = generate_scene("contacts", 2000, 1000);
  if (!made) return failed(made.error());
  auto geometry = build_geometry(made->mockup, made->tool, {});
  if (!geometry) return failed(geometry.error());
  const LoadedScene scene{.scene = {}, .geometry = std::move(*geometry)};
  const auto backend = make_ref_backend();
  if (auto ready = backend->prepare(scene.geometry, {}, {}); !ready) return failed(ready.error());
  MyDevice device(made->path);
  const auto summary =
      run_session(scene, *backend, device, {.pace = Pace::kRealtime, .duration_s = 2.5}, nullptr);
  if (!summary) return failed(summary.error());
  if (summary->failure) return failed(*summary->failure);
  std::printf("%llu ticks, at most %.2f N\n", static_cast<unsigned long long>(summary->ticks),
              summary->force_max_N);
}
