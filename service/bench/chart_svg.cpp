#include "service/bench/chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "service/report/markup.h"

namespace palpate {
namespace {

constexpr double kWidth = 760, kLeft = 86, kRight = 20, kTop = 40, kPlot = 330, kLegendRow = 20;
constexpr const char* kInks[] = {"#4269d0", "#efb118", "#ff725c", "#3ca951", "#a463f2",
                                 "#9c6b4e", "#6cc5b0", "#ff8ab7", "#97bbf5", "#9498a0"};

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
      low = std::pow(10, std::floor(std::log10(low)) - (low == high ? 1 : 0)),
      high = std::pow(10, std::ceil(std::log10(high)));
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
};

std::string head(const BenchChart& chart, double height) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" "
      "font-size=\"12\" fill=\"#333\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"14\" y=\"22\" "
      "font-size=\"15\">{}{}</text>\n",
      kWidth, height, markup_text(chart.title), chart.unit.empty() ? "" : ", " + markup_text(chart.unit));
}

/// From pale yellow to deep blue, evenly darker, so that it reads in grey, too; part 0 to 1.
std::array<int, 3> shade(double part) {
  constexpr double kStops[][3] = {{255, 247, 203}, {127, 205, 187}, {44, 127, 184}, {37, 52, 148}};
  const double at = std::clamp(part, 0.0, 1.0) * 3;
  const std::size_t stop = std::min<std::size_t>(2, static_cast<std::size_t>(at));
  std::array<int, 3> out{};
  for (std::size_t i = 0; i < 3; ++i)
    out[i] = static_cast<int>(std::lround(kStops[stop][i] + (at - static_cast<double>(stop)) *
                                                                (kStops[stop + 1][i] - kStops[stop][i])));
  return out;
}

std::string map_svg(const BenchChart& chart) {
  constexpr double kRow = 34;
  double low = HUGE_VAL, high = 0;
  for (const auto& row : chart.series)
    for (const double value : row.y)
      if (value > 0) low = std::min(low, value), high = std::max(high, value);
  if (chart.map_low > 0 && chart.map_high > chart.map_low) low = chart.map_low, high = chart.map_high;
  const double width = (kWidth - kLeft - kRight) / static_cast<double>(chart.labels.size()),
               bottom = kTop + kRow * static_cast<double>(chart.series.size());
  std::string out = head(chart, bottom + 50);
  for (std::size_t r = 0; r < chart.series.size(); ++r) {
    const auto& row = chart.series[r];
    const double y = kTop + kRow * static_cast<double>(r);
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kLeft - 7, y + kRow / 2 + 4,
                       markup_text(row.label));
    for (std::size_t c = 0; c < row.y.size(); ++c) {
      const double part = row.y[c] > 0 && high > low ? std::log(row.y[c] / low) / std::log(high / low) : 0;
      const std::array<int, 3> ink = shade(part);
      const double x = kLeft + width * static_cast<double>(c);
      out += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"rgb({},{},{})\"/><text "
          "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\">{:.4g}</text>\n",
          x + 1, y + 1, width - 2, kRow - 2, ink[0], ink[1], ink[2], x + width / 2, y + kRow / 2 + 4,
          part > 0.55 ? "white" : "#333", row.y[c]);
    }
  }
  for (std::size_t c = 0; c < chart.labels.size(); ++c)
    out += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       kLeft + width * (static_cast<double>(c) + 0.5), bottom + 17,
                       markup_text(chart.labels[c]));
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, bottom + 37, markup_text(chart.x_title));
  out += fmt::format("<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     (kTop + bottom) / 2, markup_text(chart.y_title));
  return out + "</svg>\n";
}

}  // namespace

std::string chart_svg(const BenchChart& chart) {
  if (chart.map) return map_svg(chart);
  if (!chart.labels.empty()) return {};
  Axis x{.log = chart.log_x}, y{.log = chart.log_y};
  for (const auto& series : chart.series)
    for (std::size_t i = 0; i < series.x.size(); ++i) x.hold(series.x[i]), y.hold(series.y[i]);
  x.settle();
  y.settle();
  x.from = kLeft, x.to = kWidth - kRight, y.from = kTop + kPlot, y.to = kTop;

  const std::size_t rows = (chart.series.size() + 1) / 2;
  const double height = kTop + kPlot + 52 + kLegendRow * static_cast<double>(rows);
  std::string out = head(chart, height);
  for (const double tick : x.ticks())
    out += fmt::format(
        "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4:.3g}</text>\n",
        x.at(tick), kTop, kTop + kPlot, kTop + kPlot + 17, tick);
  for (const double tick : y.ticks())
    out += fmt::format(
        "<path d=\"M{1} {0:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5:.3g}</text>\n",
        y.at(tick), kLeft, kWidth - kRight, kLeft - 7, y.at(tick) + 4, tick);
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kLeft + kWidth - kRight) / 2, kTop + kPlot + 36, markup_text(chart.x_title));
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const auto& series = chart.series[s];
    // What is expected of a series goes in its ink, dashed; so do series beyond the inks.
    const std::size_t place = series.expected && s > 0 ? s - 1 : s;
    const bool dashed = series.expected || place >= std::size(kInks);
    const char* ink = kInks[place % std::size(kInks)];
    std::string path, dots;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if ((x.log && !(series.x[i] > 0)) || (y.log && !(series.y[i] > 0))) continue;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", x.at(series.x[i]), y.at(series.y[i]));
      if (!series.expected)
        dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", x.at(series.x[i]),
                            y.at(series.y[i]), ink);
    }
    const double row = kTop + kPlot + 58 + kLegendRow * static_cast<double>(s / 2),
                 column = s % 2 == 0 ? kLeft : (kLeft + kWidth) / 2;
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"{}/>{}\n", path, ink,
                       dashed ? " stroke-dasharray=\"6 4\"" : "", dots);
    out += fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
        column, row - 10, ink, column + 18, row, markup_text(series.label));
  }
  return out + "</svg>\n";
}

}  // namespace palpate
