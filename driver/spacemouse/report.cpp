#include "driver/spacemouse/report.h"

#include <algorithm>

namespace palpate::spacemouse {
namespace {

std::int16_t axis_at(std::span<const std::uint8_t> report, std::size_t place) noexcept {
  const auto bits = static_cast<std::uint16_t>(report[place] | (report[place + 1] << 8));
  return std::clamp(static_cast<std::int16_t>(bits), static_cast<std::int16_t>(-kFullDeflection),
                    kFullDeflection);
}

void put_axes(std::span<const std::uint8_t> report, std::size_t count, std::size_t first, Cap& cap) noexcept {
  for (std::size_t i = 0; i < count; ++i) cap.axes[first + i] = axis_at(report, 1 + 2 * i);
}

}  // namespace

bool take(std::span<const std::uint8_t> report, Cap& cap) noexcept {
  if (report.size() < 2) return false;
  switch (report[0]) {
    case 1:
      if (report.size() < 7) return false;
      put_axes(report, report.size() >= 13 ? 6 : 3, 0, cap);
      return true;
    case 2:
      if (report.size() < 7) return false;
      put_axes(report, 3, 3, cap);
      return true;
    case 3: {
      std::uint32_t bits = 0;
      for (std::size_t i = 1; i < std::min<std::size_t>(report.size(), 5); ++i)
        bits |= std::uint32_t{report[i]} << (8 * (i - 1));
      cap.buttons = bits;
      return true;
    }
    default:
      return false;
  }
}

}  // namespace palpate::spacemouse
