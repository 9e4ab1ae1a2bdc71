#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "driver/falcon/packet.h"

namespace palpate::fake {

/// What goes wrong with a model of the Falcon. Counts are of the thing named; −1: never.
struct FalconFaults {
  bool deaf_to_greeting = false;
  bool leads_with_zero = false;  ///< a zero byte before the answer to the greeting, as some devices do
  int greetings_ignored = 0;
  bool deaf_to_baud = false;
  int wrong_echo_at = -1;         ///< the firmware byte whose echo differs
  int wrong_echoes = 1'000'000;   ///< how many loads that spoils
  bool silent = false;            ///< no report at all
  int bad_loads = 0;              ///< loads that end in silence, before one works
  int never_homed = 0;            ///< 1: an encoder never passes its index
  int reports_silent_after = -1;  ///< then no report any more
  int jump_at = -1;               ///< the report from which encoder 1 is off by jump_by
  int jump_by = 20000;
  int jump_reports = 1'000'000;  ///< how many reports the jump lasts
  int short_every = 0;           ///< every n-th report has 14 bytes, without j and k
  int corrupt_every = 0;         ///< every n-th report has a byte broken
  int stray_every = 0;           ///< every n-th report is followed by stray bytes
  bool splits = false;           ///< every report comes in two packets
  int merges = 0;                ///< reports kept back and sent together
};

/// A Falcon behind its serial chip, as the bus sees it: control requests and bytes in, packets out. No clock
/// and no threads: the fronts bring those. The hand that holds it is `encoders`.
class FalconModel {
 public:
  explicit FalconModel(FalconFaults wrong = {}, bool loaded = false) : faults(wrong), loaded_(loaded) {}

  FalconFaults faults;  ///< may change while it runs

  /// What the encoders read once homed, by report number since power-up.
  std::function<falcon::Encoders(int)> encoders = [](int) { return falcon::Encoders{}; };
  int homes_after = 50;  ///< reports with the homing bit until all three are homed

  /// Vendor request to the serial chip. False: stall.
  bool control(std::uint8_t request, std::uint16_t value);
  void out(std::span<const std::uint8_t> bytes);
  /// One IN packet of at most 64 bytes, status first; empty: nothing to say but status.
  std::vector<std::uint8_t> in();
  bool has_bytes() const { return !answer_.empty(); }
  void lose_homing();  ///< as after a knock: it counts to homes_after again
  void power_cycle();  ///< unplugged and plugged in: firmware and homing are gone

  const falcon::MotorCounts& motors() const { return motors_; }
  bool running() const { return loaded_; }
  bool homed() const { return homed_bits_ == 7; }
  int reports() const { return reports_; }
  int commands() const { return commands_; }
  int loads() const { return loads_; }
  std::uint8_t leds() const { return leds_; }
  const std::vector<std::uint8_t>& firmware() const { return image_; }
  std::size_t firmware_size = 0;  ///< bytes that make it whole

 private:
  enum class Baud { kNone, kGreeting, kLoading, kRunning };
  void say(std::span<const std::uint8_t> bytes) { answer_.insert(answer_.end(), bytes.begin(), bytes.end()); }
  void take_greeting(std::uint8_t byte);
  void take_image(std::uint8_t byte);
  void answer(const falcon::Command& command);

  bool loaded_;
  Baud baud_ = Baud::kNone;
  bool greeted_ = false, ready_ = false;
  std::vector<std::uint8_t> heard_, image_;
  falcon::PacketStream stream_;
  std::deque<std::uint8_t> answer_;
  std::vector<std::uint8_t> kept_back_;
  falcon::MotorCounts motors_{};
  std::uint8_t homed_bits_ = 0, leds_ = 0;
  int reports_ = 0, homing_reports_ = 0, commands_ = 0, loads_ = 0, kept_reports_ = 0, greetings_ = 0;
};

}  // namespace palpate::fake
