#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>

#include "driver/haptic_device.h"
#include "driver/inverse3/message.h"
#include "driver/inverse3/service_socket.h"
#include "model/latest_value.h"

namespace palpate::inverse3 {

/// What the control loop wants exerted, N, the arm's frame.
struct FromLoop {
  Vec3 force{0};
};

/// What went wrong since start().
struct LinkCounts {
  std::uint64_t states = 0;  ///< messages with a sound state
  std::uint64_t broken = 0;  ///< messages without one
  std::uint64_t lost = 0;    ///< times that the service or the arm went away
};

/// What the link knows of the arm.
struct FromDevice {
  Vec3 cursor{0};
  Quat orientation{1, 0, 0, 0};
  bool turned = false;  ///< the newest message had the grip's orientation
  std::uint32_t buttons = 0;
  DeviceState state = DeviceState::kOpening;
  std::int64_t time_ns = 0;   ///< steady clock, when the newest state came
  const char* guidance = "";  ///< for the person at the device; text that outlives everything
  LinkCounts counts;
};

/// A service's connection and the devices that it has.
struct Connection {
  std::unique_ptr<ServiceSocket> socket;
  Session session;
};

/// Connects to the service and asks for its devices, a second each at most. Error: kNoDevice, no service, or
/// one without an Inverse3.
Result<Connection> connect(std::uint16_t port);

/// The thread that talks to the service: one force out, one state back, about a thousand times a second. It
/// connects again when service or arm went away, and sends zero when the control loop has been silent for
/// 20 ms. The control loop's side is two mailboxes, wait-free.
class Inverse3Link {
 public:
  explicit Inverse3Link(std::uint16_t port) : port_(port) {}
  ~Inverse3Link();
  Inverse3Link(const Inverse3Link&) = delete;
  Inverse3Link& operator=(const Inverse3Link&) = delete;

  /// Connects and starts the thread. Error: kNoDevice, no service, or one without an Inverse3.
  Result<void> start();
  /// Zero force, thread ended, connection closed.
  void stop() noexcept;
  /// Whether the arm has a grip, so that it senses rotation. After start().
  bool has_grip() const noexcept { return has_grip_; }

  /// Control loop's side.
  void publish(const FromLoop& wanted) noexcept { to_device_.publish(wanted); }
  const FromDevice* take() noexcept { return from_device_.take(); }

  /// Once stopped.
  const LinkCounts& counts() const noexcept { return now_.counts; }

 private:
  void run();
  void exchange();  ///< until the connection or the arm is lost, or stop()
  void take_in(const State& state);
  Vec3 wanted_force() noexcept;
  void tell(DeviceState state, const char* guidance) noexcept;
  bool stopping() const noexcept { return stop_.load(std::memory_order_relaxed); }

  std::uint16_t port_;
  Connection to_;  // the thread's, once started; no socket: none
  bool has_grip_ = false;
  std::thread thread_;
  std::atomic<bool> stop_{false};
  LatestValue<FromLoop> to_device_;
  LatestValue<FromDevice> from_device_;
  FromDevice now_;  // the thread's
  FromLoop newest_;
  std::int64_t newest_ns_ = 0;
};

}  // namespace palpate::inverse3
