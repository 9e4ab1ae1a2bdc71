#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "driver/falcon/kinematics.h"

/// The Falcon's packets, 16 bytes each way: '<', three groups of four nibbles (int16, least significant
/// nibble first), two more values j and k, '>'. A value v travels as the byte 0x41 + v. There is no checksum,
/// so everything that can be checked is.
namespace palpate::falcon {

inline constexpr std::size_t kPacketBytes = 16;
inline constexpr std::int16_t kLargestMotorCount = 4095;  ///< beyond it the firmware's own arithmetic wraps

using Packet = std::array<std::uint8_t, kPacketBytes>;
using MotorCounts = std::array<std::int16_t, 3>;

/// Bits of a command's j.
enum CommandBits : std::uint8_t { kHomingOn = 0x01, kGreen = 0x02, kBlue = 0x04, kRed = 0x08 };

/// Grip buttons as the device reports them.
enum ButtonBits : std::uint8_t { kPlus = 1, kForward = 2, kCentreButton = 4, kMinus = 8 };

struct Command {
  MotorCounts motors{};
  std::uint8_t bits = 0;  ///< CommandBits
};

struct Report {
  Encoders encoders{};
  std::uint8_t buttons = 0;  ///< ButtonBits
  std::uint8_t homed = 0;    ///< bit i: encoder i + 1 has passed its index
};

/// A command's bytes. Motor counts beyond ±kLargestMotorCount are brought to it, all three by the same
/// factor, so that the force keeps its direction.
Packet encode(const Command& command) noexcept;
/// A report's bytes: the device's side of encode(), for models of the device.
Packet encode(const Report& report) noexcept;

/// What 16 bytes say as a report, or nothing where any byte is out of its range.
std::optional<Report> decode_report(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept;
/// What 16 bytes say as a command, for models of the device.
std::optional<Command> decode_command(std::span<const std::uint8_t, kPacketBytes> bytes) noexcept;

/// Motor counts scaled into ±kLargestMotorCount, keeping their ratios; zero where a count isn't finite.
/// Rounded to the nearest.
MotorCounts limited(const std::array<double, 3>& counts) noexcept;

/// Finds packets in a stream of bytes that may be split, merged, cut short or broken. Every '<' begins a
/// packet, for no other byte of a sound packet is one: after any damage the next whole packet is found.
class PacketStream {
 public:
  /// Takes one byte; the packet that it completes, if it is well-formed.
  std::optional<Packet> take(std::uint8_t byte) noexcept;
  /// Forgets a packet begun.
  void reset() noexcept { size_ = 0; }

  /// Packets begun and not ended as they must.
  std::uint64_t malformed() const noexcept { return malformed_; }
  std::uint64_t stray() const noexcept { return stray_; }  ///< bytes outside any packet

 private:
  Packet packet_{};
  std::size_t size_ = 0;
  std::uint64_t malformed_ = 0, stray_ = 0;
};

}  // namespace palpate::falcon
