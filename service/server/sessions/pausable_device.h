#pragma once
#include <atomic>
#include <functional>
#include <utility>

#include "driver/haptic_device.h"

namespace palpate {

/// A device that can be paused from outside. One of metal goes on telling its pose and is clutched for
/// SafeDevice, which sends it no force and fades in again afterwards; a simulated one stands still meanwhile.
/// Refers to the device. `opened`: called once it is open.
class PausableDevice final : public HapticDevice {
 public:
  PausableDevice(HapticDevice& device, bool stands_still, std::function<void()> opened = {})
      : device_(device), stands_still_(stands_still), opened_(std::move(opened)) {}

  void set_paused(bool paused) noexcept { paused_.store(paused, std::memory_order_relaxed); }  ///< any thread

  std::string name() const override { return device_.name(); }
  DeviceCapabilities capabilities() const override { return device_.capabilities(); }
  Result<void> open() override {
    Result<void> done = device_.open();
    if (done && opened_) opened_();
    return done;
  }
  void close() noexcept override { device_.close(); }
  const char* guidance() const noexcept override { return device_.guidance(); }
  DeviceSample read() noexcept override {
    DeviceSample sample = device_.read();
    sample.paused = held_ = paused_.load(std::memory_order_relaxed);
    sample.clutched |= held_ && !stands_still_;
    return sample;
  }
  Wrench exertable(const Wrench& wrench, const Vec3& gc) const noexcept override {
    return device_.exertable(wrench, gc);
  }
  void write(const Wrench& wrench, const Vec3& gc) noexcept override {
    if (!(held_ && stands_still_)) device_.write(wrench, gc);
  }

 private:
  HapticDevice& device_;
  bool stands_still_;
  std::function<void()> opened_;
  std::atomic<bool> paused_{false};
  bool held_ = false;  ///< what the tick's sample said
};

}  // namespace palpate
