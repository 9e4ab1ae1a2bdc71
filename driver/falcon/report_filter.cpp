#include "driver/falcon/report_filter.h"

#include <algorithm>
#include <cstdlib>

namespace palpate::falcon {

bool ReportFilter::take(const Report& report, int ticks) noexcept {
  const bool was_homed = homed();
  const auto said = static_cast<std::uint8_t>((report.buttons & 0xF) | (report.homed << 4));
  agreeing_ = said == candidate_ ? std::min(agreeing_ + 1, kAgreeingReports) : 1;
  candidate_ = said;
  if (agreeing_ == kAgreeingReports) {
    buttons_ = said & 0xF;
    homed_ = static_cast<std::uint8_t>(said >> 4);
  }

  // Only a homed device's encoders are judged: until then their zero moves.
  const int limit = kLargestEncoderStep * std::clamp(ticks, 1, 1000);
  bool jumped = false;
  if (was_homed && !first_)
    for (std::size_t i = 0; i < 3; ++i)
      jumped = jumped || std::abs(report.encoders[i] - encoders_[i]) > limit;
  if (jumped) {
    ++jumps_;
    ++jumps_in_a_row_;
    return false;
  }
  jumps_in_a_row_ = 0;
  encoders_ = report.encoders;
  first_ = false;
  return true;
}

}  // namespace palpate::falcon
