#include "service/chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

constexpr double kWidth = 760, kLeft = 86, kRight = 20, kTop = 40, kPlot = 330, kLegendRow = 20;
constexpr const char* kInks[] = {"#4269d0", "#efb118", "#ff725c", "#3ca951", "#a463f2", "#9c6b4e", "#6cc5b0", "#ff8ab7", "#97bbf5", "#9498a0"};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

/// One axis: from values to the picture.
struct Axis {
  double low = HUGE_VAL, high = -HUGE_VAL, from = 0, to = 1;
  bool log = false;

  void hold(double value) {
    if (log && !(value > 0)) return;
    low = std::min(low, value), high = std::max(high, value);
  }
  void settle() {
    if (!(low <= high)) low = log ? 0.1 : 0, high = 1;
    if (log) {
      low = std::pow(10, std::floor(std::log10(low)) - (low == high ? 1 : 0)), high = std::pow(10, std::ceil(std::log10(high)));
    } else {
      low = std::min(low, 0.0);
      if (low == high) high = low + 1;
    }
  }
  double at(double value) const {
    const double part = log ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    return from + (to - from) * part;
  }
  std::vector<double> ticks() const {
    std::vector<double> out;
    if (log) {
      const int decades = static_cast<int>(std::lround(std::log10(high / low))), step = std::max(1, decades / 8);
      for (int k = 0; k <= decades; k += step) out.push_back(low * std::pow(10, k));
    } else {
      const double raw = (high - low) / 6, size = std::pow(10, std::floor(std::log10(raw)));
      const double step = size * (raw / size > 5 ? 10 : raw / size > 2 ? 5 : raw / size > 1 ? 2 : 1);
      for (double v = std::ceil(low / step) * step; v <= high + step * 1e-9; v += step) out.push_back(v);
    }
    return out;
  }
};

}  // namespace

std::string chart_svg(const BenchChart& chart) {
  if (!chart.labels.empty()) return {};
  Axis x{.log = chart.log_x}, y{.log = chart.log_y};
  for (const auto& series : chart.series)
    for (std::size_t i = 0; i < series.x.size(); ++i) x.hold(series.x[i]), y.hold(series.y[i]);
  x.settle();
  y.settle();
  x.from = kLeft, x.to = kWidth - kRight, y.from = kTop + kPlot, y.to = kTop;

  const std::size_t rows = (chart.series.size() + 1) / 2;
  const double height = kTop + kPlot + 52 + kLegendRow * static_cast<double>(rows);
  std::string out = fmt::format("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
                                "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{}\" y=\"22\" font-size=\"15\">{}{}</text>\n",
                                kWidth, height, 14, escaped(chart.title), chart.unit.empty() ? "" : ", " + escaped(chart.unit));
  for (const double tick : x.ticks())
    out += fmt::format("<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4:.3g}</text>\n", x.at(tick), kTop, kTop + kPlot, kTop + kPlot + 17, tick);
  for (const double tick : y.ticks())
    out += fmt::format("<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.3g}</text>\n", y.at(tick), kLeft, kWidth - kRight, kLeft - 7, y.at(tick) + 4, tick);
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", (kLeft + kWidth - kRight) / 2, kTop + kPlot + 36, escaped(chart.x_title));
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const auto& series = chart.series[s];
    const char* ink = kInks[s % std::size(kInks)];
    std::string path, dots;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if ((x.log && !(series.x[i] > 0)) || (y.log && !(series.y[i] > 0))) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(series.x[i]), y.at(series.y[i]));
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", x.at(series.x[i]), y.at(series.y[i]), ink);
    }
    const double row = kTop + kPlot + 58 + kLegendRow * static_cast<double>(s / 2), column = s % 2 == 0 ? kLeft : (kLeft + kWidth) / 2;
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>{}\n", path, ink, s >= std::size(kInks) ? " stroke-dasharray=\"6 4\"" : "", dots);
    out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n", column, row - 10, ink, column + 18, row, escaped(series.label));
  }
  return out + "</svg>\n";
}

}  // namespace palpate
