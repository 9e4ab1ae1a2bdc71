#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "driver/falcon/falcon_device.h"
#include "driver/falcon/firmware.h"
#include "driver/falcon/report_filter.h"
#include "model/latest_value.h"

namespace palpate::falcon {

/// What the control loop wants sent.
struct FromLoop {
  MotorCounts motors{};
};

/// What happened on the bus since start().
struct BusCounts {
  std::uint64_t reports = 0;    ///< sound ones
  std::uint64_t late = 0;       ///< commands without an answer within 5 ms
  std::uint64_t malformed = 0;  ///< reports begun and not ended as they must
  std::uint64_t jumps = 0;      ///< whose encoders were rejected
  std::uint64_t errors = 0;     ///< transfers that failed: stall, babble, protocol
};

/// What the link knows of the device.
struct FromDevice {
  Encoders encoders{};
  std::uint8_t buttons = 0;
  DeviceState state = DeviceState::kOpening;
  std::int64_t time_ns = 0;   ///< steady clock, when the newest sound report came
  const char* guidance = "";  ///< for the person at the device; text that outlives everything
  BusCounts counts;
};

/// The thread that talks to a Falcon: loads, homes, exchanges packets, finds the device again. The control
/// loop's side is two mailboxes, wait-free.
class FalconLink {
 public:
  FalconLink(FalconSettings settings, std::vector<std::uint8_t> image, OpenPort open_port);
  ~FalconLink();
  FalconLink(const FalconLink&) = delete;
  FalconLink& operator=(const FalconLink&) = delete;

  /// Claims the device and starts the thread.
  Result<void> start();
  /// Motors to zero, thread ended, device released.
  void stop() noexcept;

  /// Control loop's side.
  void publish(const FromLoop& wanted) noexcept { to_device_.publish(wanted); }
  const FromDevice* take() noexcept { return from_device_.take(); }

  /// Once stopped.
  const BusCounts& counts() const noexcept { return now_.counts; }

 private:
  enum class Next { kReopen, kFault, kStop };
  void run();
  Next serve(SerialLine& line);
  std::optional<Next> bring_up(SerialLine& line);  ///< nothing once the firmware runs
  Next exchange(SerialLine& line);
  MotorCounts wanted_motors() noexcept;
  void tell(DeviceState state, const char* guidance) noexcept;
  bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }

  FalconSettings settings_;
  std::vector<std::uint8_t> image_;
  OpenPort open_port_;
  std::unique_ptr<SerialLine> line_;  // the thread's, once started
  std::thread thread_;
  std::atomic<bool> stop_{false};
  LatestValue<FromLoop> to_device_;
  LatestValue<FromDevice> from_device_;
  FromDevice now_;  // the thread's
  FromLoop newest_;
  std::int64_t newest_ns_ = 0;
};

}  // namespace palpate::falcon
