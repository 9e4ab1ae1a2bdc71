#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "driver/falcon/packet.h"
#include "driver/falcon/report_filter.h"

namespace palpate::falcon {
namespace {

std::vector<Packet> fed(PacketStream& stream, const std::vector<std::uint8_t>& bytes) {
  std::vector<Packet> packets;
  for (const std::uint8_t byte : bytes)
    if (const auto packet = stream.take(byte)) packets.push_back(*packet);
  return packets;
}

void append(std::vector<std::uint8_t>& bytes, const Packet& packet) {
  bytes.insert(bytes.end(), packet.begin(), packet.end());
}

TEST(FalconPacket, IsSpelledAsTheDeviceSpellsIt) {
  // 0x1234 travels as 4 3 2 1, −1 as F F F F, each plus 0x41; homing and the green LED are 1 | 2.
  const Packet packet = encode(Command{{0x0234, -1, 0}, kHomingOn | kGreen});
  EXPECT_EQ(std::string(packet.begin(), packet.end()), "<EDCAPPPPAAAADA>");
}

TEST(FalconPacket, ReportsComeBackWhole) {
  for (const int count : {-32768, -4096, -1, 0, 1, 255, 32767})
    for (const int homed : {0, 1, 5, 7}) {
      const Report report{{static_cast<std::int16_t>(count), 7, -7}, 0xA, static_cast<std::uint8_t>(homed)};
      const auto back = decode_report(encode(report));
      ASSERT_TRUE(back);
      EXPECT_EQ(back->encoders, report.encoders);
      EXPECT_EQ(back->buttons, report.buttons);
      EXPECT_EQ(back->homed, report.homed);
    }
}

TEST(FalconPacket, MotorCountsKeepTheirDirectionAtTheLimit) {
  const MotorCounts counts = limited({-40950, 20475, 4095});
  EXPECT_EQ(counts, (MotorCounts{-4095, 2048, 410}));  // 2047.5 and 409.5 round away from zero
  EXPECT_EQ(limited({1e300, 0, -1e300}), (MotorCounts{4095, 0, -4095}));
  EXPECT_EQ(limited({std::nan(""), 5, 5}), (MotorCounts{0, 0, 0}));
  EXPECT_EQ(limited({INFINITY, 5, 5}), (MotorCounts{0, 0, 0}));
  // What is encoded never passes the limit, whatever is asked: beyond it the firmware wraps.
  const auto sent = decode_command(encode(Command{{32767, -32768, 1}, 0}));
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->motors, (MotorCounts{4095, -4095, 0}));
}

TEST(FalconPacket, AFourteenBytePacketIsNotHomed) {
  // The short form ends where j should stand: '>' − 0x41 would read as every bit set.
  PacketStream stream;
  std::vector<std::uint8_t> bytes{'<'};
  bytes.insert(bytes.end(), 12, 'A');
  bytes.push_back('>');
  const Packet sound = encode(Report{{1, 2, 3}, 0, 0});
  append(bytes, sound);
  const std::vector<Packet> packets = fed(stream, bytes);
  ASSERT_EQ(packets.size(), 1U);
  EXPECT_EQ(packets[0], sound);
  EXPECT_EQ(stream.malformed(), 1U);
}

TEST(FalconPacket, SplitAndMergedPacketsAreFound) {
  const Packet a = encode(Report{{100, 200, 300}, 1, 7}), b = encode(Report{{-1, -2, -3}, 8, 7});
  std::vector<std::uint8_t> both;
  append(both, a);
  append(both, b);
  for (std::size_t cut = 0; cut <= both.size(); ++cut) {
    PacketStream stream;
    std::vector<Packet> packets =
        fed(stream, {both.begin(), both.begin() + static_cast<std::ptrdiff_t>(cut)});
    for (const Packet& later : fed(stream, {both.begin() + static_cast<std::ptrdiff_t>(cut), both.end()}))
      packets.push_back(later);
    EXPECT_EQ(packets, (std::vector<Packet>{a, b}));
  }
}

TEST(FalconPacket, AnyDamageIsOverAfterTheNextWholePacket) {
  // A sound stream in which a burst of random bytes stands between two packets: the second packet after the
  // burst is always found, and the first too unless the burst's last bytes began a packet that swallows
  // nothing of it ('<' restarts).
  std::mt19937 random(7);
  std::uniform_int_distribution<int> byte(0, 255), size(1, 64);
  for (int round = 0; round < 20000; ++round) {
    PacketStream stream;
    std::vector<std::uint8_t> burst(static_cast<std::size_t>(size(random)));
    for (std::uint8_t& b : burst) b = static_cast<std::uint8_t>(byte(random));
    fed(stream, burst);
    const Packet sound = encode(Report{{static_cast<std::int16_t>(round), 5, 6}, 0, 7});
    const std::vector<Packet> packets = fed(stream, {sound.begin(), sound.end()});
    ASSERT_EQ(packets.size(), 1U) << "round " << round;
    ASSERT_EQ(packets[0], sound) << "round " << round;
  }
}

TEST(FalconPacket, RandomBytesNeverMakeAnIllFormedPacket) {
  std::mt19937 random(11);
  // Bytes near the packet's own alphabet, so that whole packets do arise by chance.
  const std::string alphabet = "<>@ABCDEFGHIJKLMNOPQ";
  std::uniform_int_distribution<std::size_t> pick(0, alphabet.size() - 1);
  PacketStream stream;
  std::uint64_t found = 0;
  for (int i = 0; i < 3'000'000; ++i) {
    const auto packet = stream.take(static_cast<std::uint8_t>(alphabet[pick(random)]));
    if (!packet) continue;
    ++found;
    const auto report = decode_report(*packet);
    ASSERT_TRUE(report);
    ASSERT_EQ(decode_report(encode(*report))->encoders, report->encoders);
  }
  EXPECT_GT(found, 0U);
}

TEST(FalconReportFilter, HomingNeedsThreeAgreeingReports) {
  ReportFilter filter;
  const Report homed{{0, 0, 0}, 0, 7}, not_yet{{0, 0, 0}, 0, 3};
  filter.take(homed, 1);
  filter.take(homed, 1);
  EXPECT_FALSE(filter.homed());
  filter.take(not_yet, 1);  // a doubt starts the count anew
  filter.take(homed, 1);
  filter.take(homed, 1);
  EXPECT_FALSE(filter.homed());
  filter.take(homed, 1);
  EXPECT_TRUE(filter.homed());
  // And one damaged report does not end it.
  filter.take(not_yet, 1);
  EXPECT_TRUE(filter.homed());
}

TEST(FalconReportFilter, AnEncoderThatOutrunsAnyHandIsRejected) {
  ReportFilter filter;
  const auto report = [](int x) { return Report{{static_cast<std::int16_t>(x), 0, 0}, 0, 7}; };
  for (int i = 0; i < 3; ++i) filter.take(report(100), 1);
  ASSERT_TRUE(filter.homed());
  EXPECT_TRUE(filter.take(report(100 + kLargestEncoderStep), 1));
  EXPECT_FALSE(filter.take(report(100 + 2 * kLargestEncoderStep + 1), 1));
  EXPECT_EQ(filter.encoders()[0], 100 + kLargestEncoderStep);
  EXPECT_EQ(filter.jumps(), 1U);
  EXPECT_TRUE(filter.take(report(100 + 2 * kLargestEncoderStep + 1), 2))
      << "in twice the time it may go twice as far";
  EXPECT_FALSE(filter.lost());
}

TEST(FalconReportFilter, EncodersThatKeepJumpingAreLost) {
  ReportFilter filter;
  for (int i = 0; i < 3; ++i) filter.take(Report{{0, 0, 0}, 0, 7}, 1);
  for (int i = 1; i < kJumpsToFault; ++i) {
    EXPECT_FALSE(filter.take(Report{{20000, 0, 0}, 0, 7}, 1));
    EXPECT_FALSE(filter.lost());
  }
  filter.take(Report{{20000, 0, 0}, 0, 7}, 1);
  EXPECT_TRUE(filter.lost());
}

TEST(FalconReportFilter, EncodersMayJumpWhileHoming) {
  ReportFilter filter;
  EXPECT_TRUE(filter.take(Report{{5000, 5000, 5000}, 0, 0}, 1));
  EXPECT_TRUE(filter.take(Report{{0, 5000, 5000}, 0, 1}, 1));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(filter.take(Report{{0, 10, -10}, 0, 7}, 1));
  EXPECT_TRUE(filter.homed());
  EXPECT_EQ(filter.jumps(), 0U);
}

}  // namespace
}  // namespace palpate::falcon
