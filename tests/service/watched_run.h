#pragma once
#include <algorithm>
#include <atomic>
#include <memory>
#include <stdexcept>
#include <vector>

#include "driver/simulated_device.h"
#include "service/loop/session.h"

namespace palpate {

/// The simulated device, watched: what reached it last, and whether it was closed at zero.
class WatchedDevice : public HapticDevice {
 public:
  explicit WatchedDevice(const LoadedScene& scene) {
    auto made = make_simulated_device(scene.scene.device, scene.scene.start, Vec3(0));
    if (made) device_ = std::move(made).value();
  }
  std::string name() const override { return "simulated"; }
  double motion_s() const override { return device_->motion_s(); }
  DeviceCapabilities capabilities() const override { return device_->capabilities(); }
  Result<void> open() override { return device_->open(); }
  void close() noexcept override {
    closed_at_zero = last.force == Vec3(0) && last.torque == Vec3(0);
    device_->close();
    closed.store(true);
  }
  DeviceSample read() noexcept override {
    DeviceSample sample = device_->read();
    if (writes >= fault_after) sample.state = DeviceState::kFault;
    return sample;
  }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    last = wrench;
    strongest = std::max(strongest, length(wrench.force));
    ++writes;
    device_->write(wrench, gc);
  }

  Wrench last{Vec3(9), Vec3(9)};
  double strongest = 0;
  bool closed_at_zero = false;
  std::atomic<bool> closed = false;
  int writes = 0, fault_after = 1 << 30;

 private:
  std::unique_ptr<HapticDevice> device_;
};

/// Keeps every tick; may fail or throw at one.
class Watcher : public RunObserver {
 public:
  Result<void> on_tick(const TickRecord& tick) override {
    ticks.push_back(tick);
    if (stop_in_contact && tick.contact) stop_in_contact->store(true);
    if (static_cast<int>(ticks.size()) == fail_at) return Error{ErrorCode::kInternal, "the disk is full"};
    if (static_cast<int>(ticks.size()) == throw_at) throw std::runtime_error("out of ink");
    return {};
  }
  Result<void> on_frame(const FrameRecord& frame) override {
    frame_ticks.push_back(frame.tick);
    return {};
  }
  std::vector<TickRecord> ticks;
  std::vector<std::int64_t> frame_ticks;
  int fail_at = -1, throw_at = -1;
  std::atomic<bool>* stop_in_contact = nullptr;
};

}  // namespace palpate
