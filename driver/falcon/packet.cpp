#include "driver/falcon/packet.h"

#include <algorithm>
#include <cmath>

namespace palpate::falcon {
namespace {

constexpr std::uint8_t kOpen = '<', kClose = '>', kZero = 0x41;
constexpr std::size_t kJ = 13, kK = 14, kEnd = 15;
constexpr std::uint8_t kLargestJ = 0x7F;  // a report's: four buttons, three homed bits

void put(std::int16_t value, std::uint8_t* bytes) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  for (unsigned i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(kZero + ((bits >> (4 * i)) & 0xF));
}

std::int16_t value_at(const std::uint8_t* bytes) noexcept {
  unsigned bits = 0;
  for (unsigned i = 0; i < 4; ++i) bits |= static_cast<unsigned>(bytes[i] - kZero) << (4 * i);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
}

/// Whether a byte may stand at a place of a packet, either way.
bool fits(std::uint8_t byte, std::size_t place) noexcept {
  if (place == 0) return byte == kOpen;
  if (place == kEnd) return byte == kClose;
  const std::uint8_t largest = place == kJ ? kLargestJ : 0xF;
  return byte >= kZero && byte - kZero <= largest;
}

Packet pack(const std::array<std::int16_t, 3>& values, std::uint8_t j) noexcept {
  Packet packet{};
  packet[0] = kOpen;
  for (std::size_t i = 0; i < 3; ++i) put(values[i], packet.data() + 1 + 4 * i);
  packet[kJ] = static_cast<std::uint8_t>(kZero + j);
  packet[kK] = kZero;
  packet[kEnd] = kClose;
  return packet;
}

bool well_formed(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  for (std::size_t i = 0; i < kPacketBytes; ++i)
    if (!fits(bytes[i], i)) return false;
  return true;
}

std::array<std::int16_t, 3> values_of(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  return {value_at(bytes.data() + 1), value_at(bytes.data() + 5), value_at(bytes.data() + 9)};
}

}  // namespace

MotorCounts limited(const std::array<double, 3>& counts) noexcept {
  double largest = 0;
  for (const double count : counts) {
    if (!std::isfinite(count)) return {};
    largest = std::max(largest, std::abs(count));
  }
  const double factor = largest > kLargestMotorCount ? kLargestMotorCount / largest : 1;
  MotorCounts out{};
  // The factor's rounding can leave the largest count a hair beyond the limit, not half a count: rounding
  // settles it.
  for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::int16_t>(std::lround(counts[i] * factor));
  return out;
}

Packet encode(const Command& command) noexcept {
  const MotorCounts& m = command.motors;
  return pack(limited({double(m[0]), double(m[1]), double(m[2])}), command.bits & 0xF);
}

Packet encode(const Report& report) noexcept {
  return pack(report.encoders, static_cast<std::uint8_t>((report.buttons & 0xF) | ((report.homed & 7) << 4)));
}

std::optional<Report> decode_report(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  if (!well_formed(bytes)) return std::nullopt;
  const auto j = static_cast<std::uint8_t>(bytes[kJ] - kZero);
  return Report{values_of(bytes), static_cast<std::uint8_t>(j & 0xF), static_cast<std::uint8_t>(j >> 4)};
}

std::optional<Command> decode_command(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept {
  if (!well_formed(bytes)) return std::nullopt;
  const auto j = static_cast<std::uint8_t>(bytes[kJ] - kZero);
  if (j > 0xF) return std::nullopt;
  return Command{values_of(bytes), j};
}

std::optional<Packet> PacketStream::take(std::uint8_t byte) noexcept {
  if (byte == kOpen) {
    if (size_ > 0) ++malformed_;
    packet_[0] = byte;
    size_ = 1;
    return std::nullopt;
  }
  if (size_ == 0) {
    ++stray_;
    return std::nullopt;
  }
  if (!fits(byte, size_)) {
    ++malformed_;
    size_ = 0;
    return std::nullopt;
  }
  packet_[size_++] = byte;
  if (size_ < kPacketBytes) return std::nullopt;
  size_ = 0;
  return packet_;
}

}  // namespace palpate::falcon
