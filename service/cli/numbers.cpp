#include "service/cli/numbers.h"

#include <fmt/format.h>

#include <array>

namespace palpate {

std::string count_text(std::uint64_t count) {
  const std::string digits = std::to_string(count);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text.push_back(',');
    text.push_back(digits[i]);
  }
  return text;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  if (bytes == 0) return "–";
  if (bytes < 1024) return fmt::format("{} B", bytes);
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  while (value >= 1024 && unit + 1 < kUnits.size()) {
    value /= 1024;
    ++unit;
  }
  return fmt::format("{:.1f} {}", value, kUnits[unit]);
}

std::string length_text(double m) {
  if (m == 0) return "0";
  // 999.5 rounds to 1,000, which is one of the next unit.
  return m >= 0.9995e-3   ? fmt::format("{:.4g} mm", m * 1e3)
         : m >= 0.9995e-6 ? fmt::format("{:.3g} µm", m * 1e6)
                          : fmt::format("{:.3g} nm", m * 1e9);
}

}  // namespace palpate
