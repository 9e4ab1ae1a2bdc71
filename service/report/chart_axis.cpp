#include "service/report/chart_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "service/report/markup.h"

namespace palpate {
namespace {

constexpr const char* kInks[] = {"#4269d0", "#efb118", "#ff725c", "#3ca951", "#a463f2",
                                 "#9c6b4e", "#6cc5b0", "#ff8ab7", "#97bbf5", "#9498a0"};

}  // namespace

void ChartAxis::hold(double value) {
  if (!std::isfinite(value) || (log && !(value > 0))) return;
  low = std::min(low, value), high = std::max(high, value);
}

void ChartAxis::settle() {
  if (!(low <= high)) low = log ? 0.1 : 0, high = 1;
  if (log) {
    low = std::pow(10, std::floor(std::log10(low)) - (low == high ? 1 : 0)),
    high = std::pow(10, std::ceil(std::log10(high)));
    if (low == high) high *= 10;
  } else {
    low = std::min(low, 0.0);
    if (low == high) high = low + 1;
  }
}

double ChartAxis::at(double value) const {
  const double part = log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
  return from + (to - from) * part;
}

std::vector<double> ChartAxis::ticks() const {
  std::vector<double> out;
  if (log) {
    const int decades = static_cast<int>(std::lround(std::log10(high / low))),
              step = std::max(1, decades / 8);
    for (int k = 0; k <= decades; k += step) out.push_back(low * std::pow(10, k));
  } else {
    const double raw = (high - low) / 6, size = std::pow(10, std::floor(std::log10(raw)));
    const double step = size * (raw / size > 5 ? 10 : raw / size > 2 ? 5 : raw / size > 1 ? 2 : 1);
    for (double v = std::ceil(low / step) * step; v <= high + step * 1e-9; v += step) out.push_back(v);
  }
  return out;
}

std::string tick_text(double value) {
  const double size = std::abs(value);
  if (!(size >= 999.5 && size < 999'500)) return fmt::format("{:.3g}", value);
  const long whole = std::lround(value);
  return fmt::format("{},{:03}", whole / 1000, std::labs(whole) % 1000);
}

std::string chart_head(const std::string& title, const std::string& unit, double height) {
  const std::string whole = title + (unit.empty() ? "" : ", " + unit);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" "
      "font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
      "<rect class=\"ground\" width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"14\" y=\"22\" "
      "font-size=\"15\">{}</text>\n",
      kChartWidth, height, markup_text(whole), markup_text(whole));
}

const char* chart_ink(std::size_t number) { return kInks[number % std::size(kInks)]; }

std::size_t chart_inks() { return std::size(kInks); }

}  // namespace palpate
