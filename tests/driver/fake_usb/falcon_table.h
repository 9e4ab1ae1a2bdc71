#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "driver/falcon/falcon_device.h"
#include "tests/driver/fake_usb/descriptor_front.h"
#include "tests/driver/fake_usb/falcon_model.h"

namespace palpate::fake {

/// A Falcon on a table: a model, its plug, and the driver's way to find it. Counts the commands with force
/// that reach the model before it is homed.
class FalconTable {
 public:
  static constexpr std::size_t kFirmwareBytes = 300;

  explicit FalconTable(FalconFaults faults = {}, bool loaded = false,
                       std::size_t firmware_bytes = kFirmwareBytes)
      : model(faults, loaded) {
    model.firmware_size = firmware_bytes;
    plug();
  }
  /// Plugged in (anew), seen by the driver at once or when `plugged` is set. What was plugged in before stays
  /// for as long as the driver holds it.
  void plug(bool seen = true) {
    const std::lock_guard lock(plug_mutex_);
    if (front) drawer_.push_back(std::move(front));
    front = std::make_unique<DescriptorFront>(
        DeviceCalls{[this](std::uint8_t r, std::uint16_t v) { return model.control(r, v); },
                    [this](std::span<const std::uint8_t> b) {
                      model.out(b);
                      if (model.motors() != falcon::MotorCounts{} && !model.homed()) ++forces_unhomed;
                    },
                    [this] { return model.in(); }, [this] { return model.has_bytes(); }},
        bulk_pair_descriptors(falcon::kUsbId.vendor, falcon::kUsbId.product));
    plugged = seen;
  }
  void unplug() {
    plugged = false;
    front->unplug();
  }
  falcon::OpenPort opener() {
    return [this]() -> Result<std::unique_ptr<UsbPort>> {
      const std::lock_guard lock(plug_mutex_);
      if (!plugged) return Error{ErrorCode::kNoDevice, "nothing is plugged in"};
      return UsbPort::open_descriptor(front->descriptor(), 0);
    };
  }
  template <class F>
  auto locked(F&& look) {
    return front->locked(std::forward<F>(look));
  }

  FalconModel model;
  std::unique_ptr<DescriptorFront> front;
  std::atomic<bool> plugged{false};
  std::atomic<int> forces_unhomed{0};

 private:
  std::mutex plug_mutex_;
  std::vector<std::unique_ptr<DescriptorFront>> drawer_;
};

}  // namespace palpate::fake
