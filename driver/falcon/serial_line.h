#pragma once
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "driver/usb_port.h"
#include "model/result.h"

namespace palpate::falcon {

/// Values of the serial chip's baud rate request.
enum class Baud : std::uint16_t { k9600 = 0x4138, k142857 = 0x0015, k1500000 = 0x0002 };

/// The Falcon's serial line: an FTDI chip behind a USB port. Every IN packet of the chip opens with two bytes
/// of modem status, which are dropped here. For the device's own thread.
class SerialLine {
 public:
  using Milliseconds = std::chrono::milliseconds;

  explicit SerialLine(std::unique_ptr<UsbPort> port);

  /// Begins to listen. Before anything else.
  Result<void> begin();
  Result<void> purge();  ///< throws away what waits in the chip, both ways, and here
  Result<void> set_latency(std::uint8_t milliseconds);
  Result<void> set_baud(Baud baud);
  Result<void> set_frame_8n1();
  Result<void> set_no_flow_control();
  Result<void> set_dtr(bool high);
  Result<void> set_rts_low();

  Result<void> write(std::span<const std::uint8_t> bytes, Milliseconds timeout);
  /// Up to `count` bytes, as many as arrive within `timeout`; returns at once when they are there.
  std::vector<std::uint8_t> read(std::size_t count, Milliseconds timeout);

  /// The two below serve the running device: no waiting for answers.
  bool send(std::span<const std::uint8_t> bytes) { return port_->send(kOut, bytes); }
  /// Waits at most `timeout` for the bus, then hands over every byte that has come.
  template <class Take>
  void take(std::chrono::microseconds timeout, Take&& take_byte) {
    port_->pump(timeout);
    while (!received_.empty()) {
      take_byte(received_.front());
      received_.pop_front();
    }
  }

  bool lost() const noexcept { return port_->lost(); }
  std::uint64_t errors() const noexcept { return port_->errors(); }

 private:
  static constexpr std::uint8_t kOut = 0x02, kIn = 0x81;
  Result<void> request(std::uint8_t request, std::uint16_t value);

  std::deque<std::uint8_t> received_;  // before port_, whose callback fills it
  std::unique_ptr<UsbPort> port_;
};

}  // namespace palpate::falcon
