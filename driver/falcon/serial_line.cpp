#include "driver/falcon/serial_line.h"

namespace palpate::falcon {
namespace {

constexpr std::uint8_t kVendorOut = 0x40;
constexpr std::size_t kPacket = 64, kStatus = 2;
constexpr auto kRequestTime = std::chrono::milliseconds(500);
// Babble must not fill the memory: no answer of the device is longer than a firmware chunk's echo.
constexpr std::size_t kMostKept = 4096;

}  // namespace

SerialLine::SerialLine(std::unique_ptr<UsbPort> port) : port_(std::move(port)) {}

Result<void> SerialLine::begin() {
  return port_->listen(kIn, false, kPacket, [this](std::span<const std::uint8_t> packet) {
    if (packet.size() <= kStatus || received_.size() > kMostKept) return;
    received_.insert(received_.end(), packet.begin() + kStatus, packet.end());
  });
}

Result<void> SerialLine::request(std::uint8_t number, std::uint16_t value) {
  return port_->control(kVendorOut, number, value, 0, kRequestTime);
}

Result<void> SerialLine::purge() {
  if (auto done = request(0, 1); !done) return done;
  if (auto done = request(0, 2); !done) return done;
  port_->pump(std::chrono::microseconds(0));
  received_.clear();
  return {};
}

Result<void> SerialLine::set_latency(std::uint8_t milliseconds) { return request(9, milliseconds); }
Result<void> SerialLine::set_baud(Baud baud) { return request(3, static_cast<std::uint16_t>(baud)); }
Result<void> SerialLine::set_frame_8n1() { return request(4, 0x0008); }
Result<void> SerialLine::set_no_flow_control() { return request(2, 0); }
Result<void> SerialLine::set_dtr(bool high) { return request(1, high ? 0x0101 : 0x0100); }
Result<void> SerialLine::set_rts_low() { return request(1, 0x0200); }

Result<void> SerialLine::write(std::span<const std::uint8_t> bytes, Milliseconds timeout) {
  return port_->write(kOut, bytes, timeout);
}

std::vector<std::uint8_t> SerialLine::read(std::size_t count, Milliseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (received_.size() < count && !port_->lost()) {
    const auto left =
        std::chrono::duration_cast<std::chrono::microseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) break;
    port_->pump(left);
  }
  const std::size_t taken = std::min(count, received_.size());
  const auto last = received_.begin() + static_cast<std::ptrdiff_t>(taken);
  std::vector<std::uint8_t> bytes(received_.begin(), last);
  received_.erase(received_.begin(), last);
  return bytes;
}

}  // namespace palpate::falcon
