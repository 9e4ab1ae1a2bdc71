#pragma once
#include <cstdint>

#include "driver/falcon/packet.h"

namespace palpate::falcon {

/// Largest speed of an encoder that a hand can cause, counts a tick of 1 ms. The grip at 5 m/s turns an upper
/// arm of 0.06 m at 83 rad/s, which is 131 counts a tick; rounded up.
inline constexpr int kLargestEncoderStep = 140;
/// Well-formed reports in a row that must agree before buttons or homing change: no checksum guards them.
inline constexpr int kAgreeingReports = 3;
/// Reports in a row whose encoders jumped, after which it is no damaged packet but lost homing, and the
/// device at fault.
inline constexpr int kJumpsToFault = 10;

/// What to believe of the reports that arrive. No clock: the caller says how many ticks lie between two
/// reports.
class ReportFilter {
 public:
  /// Takes a well-formed report that came `ticks` ticks after the last one taken (at least 1). True if its
  /// encoders were taken. While not all three encoders are homed, and on the report that ends homing, they
  /// may jump: their zero is being found.
  bool take(const Report& report, int ticks) noexcept;
  void reset() noexcept { *this = ReportFilter(); }

  const Encoders& encoders() const noexcept { return encoders_; }
  std::uint8_t buttons() const noexcept { return buttons_; }
  bool homed() const noexcept { return homed_ == 7; }
  std::uint8_t homed_bits() const noexcept { return homed_; }
  /// Encoders kept jumping: positions can't be trusted until homed again.
  bool lost() const noexcept { return jumps_in_a_row_ >= kJumpsToFault; }
  std::uint64_t jumps() const noexcept { return jumps_; }  ///< reports whose encoders were rejected

 private:
  Encoders encoders_{};
  std::uint8_t buttons_ = 0, homed_ = 0;
  std::uint8_t candidate_ = 0;  ///< buttons and homed bits of the last report, not yet believed
  int agreeing_ = 0;            ///< how many reports in a row said so
  int jumps_in_a_row_ = 0;
  bool first_ = true;
  std::uint64_t jumps_ = 0;
};

}  // namespace palpate::falcon
