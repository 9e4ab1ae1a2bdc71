// The Falcon's codec under bytes from a broken bus: sound reports, cut, doubled, flipped, delayed among
// noise. PALPATE_FUZZ_BYTES says how many.
#include <gtest/gtest.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "driver/falcon/packet.h"
#include "driver/falcon/report_filter.h"

namespace palpate::falcon {
namespace {

/// Bytes of a bus that breaks: what damages the stream, and sound reports between. `sound` says which bytes
/// end an untouched packet.
class BrokenBus {
 public:
  explicit BrokenBus(std::uint64_t seed) : random_(seed) {}

  /// The next stretch of bytes, damaged.
  void damage(std::vector<std::uint8_t>& bytes) {
    bytes.clear();
    const auto some = [&](std::size_t most) { return below(most) + 1; };
    switch (below(8)) {
      case 0:  // noise
        for (std::size_t n = some(40); n > 0; --n) bytes.push_back(any());
        break;
      case 1:  // noise of the packet's own alphabet
        for (std::size_t n = some(40); n > 0; --n)
          bytes.push_back(static_cast<std::uint8_t>("<>@ABCDEFGHIJKLMNOPQ\xC0"[below(21)]));
        break;
      case 2: {  // a packet cut short
        const Packet packet = sound();
        bytes.assign(packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(some(kPacketBytes - 1)));
        break;
      }
      case 3: {  // one without its head
        const Packet packet = sound();
        bytes.assign(packet.begin() + static_cast<std::ptrdiff_t>(some(kPacketBytes - 1)), packet.end());
        break;
      }
      case 4: {  // a bit flipped
        const Packet packet = sound();
        bytes.assign(packet.begin(), packet.end());
        bytes[below(kPacketBytes)] ^= static_cast<std::uint8_t>(1u << below(8));
        break;
      }
      case 5: {  // a byte too many
        const Packet packet = sound();
        bytes.assign(packet.begin(), packet.end());
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(kPacketBytes)), any());
        break;
      }
      case 6: {  // the form of 14 bytes
        const Packet packet = sound();
        bytes.assign(packet.begin(), packet.end());
        bytes.erase(bytes.begin() + 13, bytes.begin() + 15);
        break;
      }
      default:  // stray ends
        bytes.assign(some(6), '>');
    }
  }
  /// Mostly of a hand that moves on with the same buttons, now and then of another one.
  Packet sound() {
    if (below(10) == 0)
      last_ = {{word(), word(), word()},
               static_cast<std::uint8_t>(below(16)),
               static_cast<std::uint8_t>(below(4) == 0 ? below(8) : 7)};
    for (std::int16_t& count : last_.encoders)
      count = static_cast<std::int16_t>(count + static_cast<int>(below(301)) - 150);
    return encode(last_);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_() % n); }

 private:
  std::uint8_t any() { return static_cast<std::uint8_t>(random_()); }
  std::int16_t word() { return static_cast<std::int16_t>(static_cast<std::uint16_t>(random_())); }
  std::mt19937_64 random_;
  Report last_{};
};

TEST(FalconCodecFuzz, AfterAnyDamageItIsBackWithinTwoPackets) {
  const char* wanted = std::getenv("PALPATE_FUZZ_BYTES");
  const std::uint64_t bytes_wanted = wanted ? std::stoull(wanted) : 3'000'000;
  BrokenBus bus(20260607);
  PacketStream stream;
  ReportFilter filter;
  std::uint64_t bytes = 0, damages = 0, late = 0, false_packets = 0, homed_reports = 0;
  std::uint8_t last_said = 0;
  int agreeing = 0;  // of the reports that came out, as the filter must count them
  std::vector<std::uint8_t> stretch;
  /// Feeds a byte; the packet that came out went through the filter, whose rules are checked against a count
  /// of our own.
  const auto feed = [&](std::uint8_t byte) -> std::optional<Packet> {
    ++bytes;
    const auto packet = stream.take(byte);
    if (!packet) return packet;
    const auto report = decode_report(*packet);
    EXPECT_TRUE(report) << "a packet that is no report";
    if (!report) return packet;
    const bool was_homed = filter.homed();
    const std::uint8_t buttons = filter.buttons(), homed = filter.homed_bits();
    const Encoders before = filter.encoders();
    const bool taken = filter.take(*report, 1);
    const auto said = static_cast<std::uint8_t>(report->buttons | (report->homed << 4));
    agreeing = said == last_said ? agreeing + 1 : 1;
    last_said = said;
    if (filter.buttons() != buttons || filter.homed_bits() != homed) {
      EXPECT_GE(agreeing, kAgreeingReports) << "believed too early";
    }
    for (std::size_t i = 0; was_homed && taken && i < 3; ++i) {
      EXPECT_LE(std::abs(filter.encoders()[i] - before[i]), kLargestEncoderStep);
    }
    homed_reports += was_homed;
    if (!taken) {
      EXPECT_EQ(filter.encoders(), before) << "a rejected report leaves no trace";
    }
    if (filter.lost()) {
      filter.reset();
      last_said = 0;
      agreeing = 0;
    }
    return packet;
  };
  while (bytes < bytes_wanted) {
    ++damages;
    for (std::size_t n = bus.below(3) + 1; n > 0; --n) {
      bus.damage(stretch);
      for (const std::uint8_t byte : stretch)
        if (feed(byte)) ++false_packets;  // noise that happens to be one: without a checksum nobody can tell
    }
    // Then sound packets: the second at the latest comes out, and all that follow.
    for (int i = 0; i < 4; ++i) {
      const Packet sound = bus.sound();
      std::optional<Packet> out;
      for (const std::uint8_t byte : sound)
        if (const auto packet = feed(byte)) {
          ASSERT_FALSE(out) << "two packets of one";
          out = packet;
        }
      const bool there = out == sound;
      late += i == 0 && !there;
      if (i > 0) {
        ASSERT_TRUE(there) << "damage " << damages << ", packet " << i;
      }
    }
  }
  EXPECT_GT(homed_reports, 0u);
  std::printf("%" PRIu64 " bytes, %" PRIu64 " stretches of damage: first packet after it lost %" PRIu64
              " times, second never; %" PRIu64 " packets made by damage; %" PRIu64 " malformed, %" PRIu64
              " stray bytes\n",
              bytes, damages, late, false_packets, stream.malformed(), stream.stray());
}

}  // namespace
}  // namespace palpate::falcon
