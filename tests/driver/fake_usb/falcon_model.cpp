#include "tests/driver/fake_usb/falcon_model.h"

#include <algorithm>
#include <array>

namespace palpate::fake {

using namespace palpate::falcon;

bool FalconModel::control(std::uint8_t request, std::uint16_t value) {
  switch (request) {
    case 0:
      if (value == 1 || value == 2) answer_.clear();
      return true;
    case 3:
      heard_.clear();
      stream_.reset();
      if (value == 0x4138) {
        baud_ = Baud::kGreeting;
        greeted_ = ready_ = false;
        loaded_ = false;
        image_.clear();
      } else if (value == 0x0015) {
        baud_ = Baud::kLoading;
      } else if (value == 0x0002) {
        baud_ = Baud::kRunning;
        if (greeted_ && ready_ && !image_.empty() && image_.size() == firmware_size) {
          ++loads_;
          loaded_ = loads_ > faults.bad_loads;
        }
        greeted_ = false;
      } else {
        return false;
      }
      return true;
    case 1:
    case 2:
    case 4:
    case 9:
      return true;
    default:
      return false;
  }
}

void FalconModel::take_greeting(std::uint8_t byte) {
  heard_.push_back(byte);
  constexpr std::array<std::uint8_t, 3> greeting{0x0A, 0x43, 0x0D};
  if (heard_.size() < 3 || !std::equal(greeting.begin(), greeting.end(), heard_.end() - 3)) return;
  heard_.clear();
  if (faults.deaf_to_greeting || greetings_++ < faults.greetings_ignored) return;
  if (faults.leads_with_zero) answer_.push_back(0);
  constexpr std::array<std::uint8_t, 4> greeted{0x0A, 0x44, 0x2C, 0x0D};
  say(greeted);
  greeted_ = true;
}

void FalconModel::take_image(std::uint8_t byte) {
  if (!greeted_ || faults.deaf_to_baud) return;
  if (!ready_) {
    ready_ = byte == 0x41;
    if (ready_) answer_.push_back(0x41);
    return;
  }
  const bool wrong = static_cast<int>(image_.size()) == faults.wrong_echo_at && faults.wrong_echoes-- > 0;
  image_.push_back(byte);
  answer_.push_back(wrong ? static_cast<std::uint8_t>(byte ^ 1) : byte);
}

void FalconModel::out(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (baud_ == Baud::kGreeting) take_greeting(byte);
    if (baud_ == Baud::kLoading) take_image(byte);
    if (baud_ != Baud::kRunning || !loaded_) continue;
    if (const auto packet = stream_.take(byte))
      if (const auto command = decode_command(*packet)) answer(*command);
  }
}

void FalconModel::answer(const Command& command) {
  ++commands_;
  motors_ = command.motors;
  leds_ = static_cast<std::uint8_t>(command.bits & (kGreen | kBlue | kRed));
  if ((command.bits & kHomingOn) != 0 && ++homing_reports_ >= homes_after)
    homed_bits_ = faults.never_homed ? 3 : 7;
  const int number = reports_++;
  if (faults.silent) return;
  if (faults.reports_silent_after >= 0 && number >= faults.reports_silent_after) return;
  Report report{encoders(number), 0, homed_bits_};
  if (faults.jump_at >= 0 && number >= faults.jump_at && number < faults.jump_at + faults.jump_reports)
    report.encoders[0] = static_cast<std::int16_t>(report.encoders[0] + faults.jump_by);
  const Packet packet = encode(report);
  std::vector<std::uint8_t> bytes(packet.begin(), packet.end());
  const auto hits = [number](int every) { return every > 0 && number % every == every - 1; };
  if (hits(faults.short_every)) bytes.erase(bytes.begin() + 13, bytes.begin() + 15);
  if (hits(faults.corrupt_every)) bytes[static_cast<std::size_t>(number) % bytes.size()] ^= 0x80;
  constexpr std::array<std::uint8_t, 5> stray{'>', '>', 'P', 0xFF, 0x00};
  if (hits(faults.stray_every))
    for (const std::uint8_t byte : stray) bytes.push_back(byte);
  kept_back_.insert(kept_back_.end(), bytes.begin(), bytes.end());
  if (++kept_reports_ <= faults.merges) return;
  say(kept_back_);
  kept_back_.clear();
  kept_reports_ = 0;
}

std::vector<std::uint8_t> FalconModel::in() {
  const std::size_t said = std::min<std::size_t>(faults.splits ? 9 : 62, answer_.size());
  std::vector<std::uint8_t> packet(2 + said);
  packet[0] = 0x01;  // modem status: carrier lines, transmitter empty
  packet[1] = 0x60;
  std::copy_n(answer_.begin(), said, packet.begin() + 2);
  answer_.erase(answer_.begin(), answer_.begin() + static_cast<std::ptrdiff_t>(said));
  return packet;
}

void FalconModel::lose_homing() {
  homed_bits_ = 0;
  homing_reports_ = 0;
}

void FalconModel::power_cycle() {
  loaded_ = greeted_ = ready_ = false;
  baud_ = Baud::kNone;
  heard_.clear();
  image_.clear();
  answer_.clear();
  kept_back_.clear();
  kept_reports_ = 0;
  stream_.reset();
  motors_ = {};
  homed_bits_ = leds_ = 0;
  homing_reports_ = 0;
}

}  // namespace palpate::fake
