#include "service/report/chart_svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "service/report/chart_axis.h"
#include "service/report/markup.h"

namespace palpate {
namespace {

constexpr double kLegendRow = 20, kBottom = kChartTop + kChartPlot;

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

std::string map_svg(const Chart& chart) {
  constexpr double kRow = 34;
  double low = HUGE_VAL, high = 0;
  for (const auto& row : chart.series)
    for (const double value : row.y)
      if (value > 0) low = std::min(low, value), high = std::max(high, value);
  if (chart.map_low > 0 && chart.map_high > chart.map_low) low = chart.map_low, high = chart.map_high;
  const double width = (kChartWidth - kChartLeft - kChartRight) / static_cast<double>(chart.labels.size()),
               bottom = kChartTop + kRow * static_cast<double>(chart.series.size());
  std::string out = chart_head(chart.title, chart.unit, bottom + 50);
  for (std::size_t r = 0; r < chart.series.size(); ++r) {
    const auto& row = chart.series[r];
    const double y = kChartTop + kRow * static_cast<double>(r);
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kChartLeft - 7,
                       y + kRow / 2 + 4, markup_text(row.label));
    for (std::size_t c = 0; c < row.y.size(); ++c) {
      const double part = row.y[c] > 0 && high > low ? std::log(row.y[c] / low) / std::log(high / low) : 0;
      const std::array<int, 3> ink = shade(part);
      const double x = kChartLeft + width * static_cast<double>(c);
      out += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"rgb({},{},{})\"/><text "
          "x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"{}\">{:.4g}</text>\n",
          x + 1, y + 1, width - 2, kRow - 2, ink[0], ink[1], ink[2], x + width / 2, y + kRow / 2 + 4,
          part > 0.55 ? "white" : "#333", row.y[c]);
    }
  }
  for (std::size_t c = 0; c < chart.labels.size(); ++c)
    out += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       kChartLeft + width * (static_cast<double>(c) + 0.5), bottom + 17,
                       markup_text(chart.labels[c]));
  out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                     (kChartLeft + kChartWidth - kChartRight) / 2, bottom + 37, markup_text(chart.x_title));
  out += fmt::format("<text transform=\"translate(18 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     (kChartTop + bottom) / 2, markup_text(chart.y_title));
  return out + "</svg>\n";
}

std::string marker(Chart::Marker shape, double x, double y, const char* ink) {
  switch (shape) {
    case Chart::Marker::kCircle:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", x, y, ink);
    case Chart::Marker::kSquare:
      return fmt::format("<path d=\"M{:.1f} {:.1f}h6v6h-6Z\" fill=\"{}\"/>", x - 3, y - 3, ink);
    case Chart::Marker::kTriangle:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4 7h-8Z\" fill=\"{}\"/>", x, y - 4, ink);
    case Chart::Marker::kDiamond:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4 4l-4 4l-4 -4Z\" fill=\"{}\"/>", x, y - 4, ink);
    case Chart::Marker::kCross:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l7 7m0 -7l-7 7\" stroke=\"{}\" stroke-width=\"2\"/>",
                         x - 3.5, y - 3.5, ink);
    case Chart::Marker::kNone:
      break;
  }
  return "";
}

std::string axis_marks(const ChartAxis* x, const ChartAxis& y, const std::string& x_title) {
  std::string out;
  if (x != nullptr)
    for (const double tick : x->ticks())
      out += fmt::format(
          "<path class=\"grid\" d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
          "text-anchor=\"middle\">{4}</text>\n",
          x->at(tick), kChartTop, kBottom, kBottom + 17, tick_text(tick));
  for (const double tick : y.ticks())
    out += fmt::format(
        "<path class=\"grid\" d=\"M{1} {0:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
        "text-anchor=\"end\">{5}</text>\n",
        y.at(tick), kChartLeft, kChartWidth - kChartRight, kChartLeft - 7, y.at(tick) + 4, tick_text(tick));
  return out + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                           (kChartLeft + kChartWidth - kChartRight) / 2, kBottom + 36, markup_text(x_title));
}

/// Place of a series' name below the plot.
std::pair<double, double> legend_place(std::size_t number) {
  const std::size_t row = number / 2;
  return {number % 2 == 0 ? kChartLeft : (kChartLeft + kChartWidth) / 2,
          kBottom + 58 + kLegendRow * static_cast<double>(row)};
}

double lines_height(const Chart& chart) {
  const std::size_t rows = (chart.series.size() + 1) / 2;
  return kBottom + 52 + kLegendRow * static_cast<double>(rows);
}

std::string lines_svg(const Chart& chart) {
  ChartAxis x{.log = chart.log_x}, y{.log = chart.log_y};
  for (const auto& series : chart.series)
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      x.hold(series.x[i]);
      if (chart.y_most > 0 && !(series.y[i] <= chart.y_most)) continue;
      y.hold(series.y[i]);
    }
  for (const auto& rule : chart.rules) x.hold(rule.x);
  x.settle();
  y.settle();
  x.from = kChartLeft, x.to = kChartWidth - kChartRight, y.from = kBottom, y.to = kChartTop;

  std::string out =
      chart_head(chart.title, chart.unit, lines_height(chart)) + axis_marks(&x, y, chart.x_title);
  for (const auto& rule : chart.rules)
    out += fmt::format(
        "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#888\" stroke-width=\"1.5\"/><text x=\"{3:.1f}\" "
        "y=\"{4}\">{5}</text>\n",
        x.at(rule.x), kChartTop, kBottom, x.at(rule.x) + 4, kBottom - 6, markup_text(rule.label));
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const auto& series = chart.series[s];
    // What is expected of a series goes in its ink, dashed; so do series beyond the inks.
    const std::size_t place = series.ink.value_or(series.expected && s > 0 ? s - 1 : s);
    const bool dashed = series.expected || series.dashed || place >= chart_inks();
    const char* ink = series.guide ? "#999" : chart_ink(place);
    std::string path, dots;
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if ((x.log && !(series.x[i] > 0)) || (y.log && !(series.y[i] > 0))) continue;
      const double px = x.at(series.x[i]);
      if (chart.y_most > 0 && !(series.y[i] <= chart.y_most)) {
        dots += fmt::format(
            "<path d=\"M{:.1f} {:.1f}l5 9h-10Z\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>", px,
            kChartTop + 2, ink);
        continue;
      }
      const double py = y.at(series.y[i]);
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px, py);
      if (!series.expected && !series.guide) dots += marker(series.marker, px, py, ink);
      if (i < series.names.size() && !series.names[i].empty())
        dots += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"9\" fill=\"{}\">{}</text>", px + 5,
                            py - 4, ink, markup_text(series.names[i]));
    }
    const auto [column, row] = legend_place(s);
    if (series.line && !path.empty())
      out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>", path, ink,
                         series.guide ? 1 : 2, dashed ? " stroke-dasharray=\"6 4\"" : "");
    out += dots + "\n";
    // The legend shows a series as it is drawn.
    if (series.line)
      out += fmt::format("<path d=\"M{} {}h20\" stroke=\"{}\" stroke-width=\"{}\"{}/>", column, row - 4, ink,
                         series.guide ? 1 : 2, dashed ? " stroke-dasharray=\"6 4\"" : "");
    if (!series.expected && !series.guide) out += marker(series.marker, column + 10, row - 4, ink);
    out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n", column + 26, row, markup_text(series.label));
  }
  return out + "</svg>\n";
}

/// Bars beside each other, or on each other; a name for each group below, slanted where there are many.
std::string bars_svg(const Chart& chart) {
  ChartAxis y{.log = chart.log_y && !chart.stacked};
  std::vector<double> sums(chart.labels.size(), 0.0);
  for (const auto& series : chart.series)
    for (std::size_t i = 0; i < series.y.size() && i < sums.size(); ++i) {
      sums[i] += series.y[i];
      y.hold(chart.stacked ? sums[i] : series.y[i]);
    }
  y.settle();
  y.from = kBottom, y.to = kChartTop;
  const double slot = (kChartWidth - kChartLeft - kChartRight) / static_cast<double>(chart.labels.size());
  std::size_t longest = 0;
  for (const std::string& label : chart.labels) longest = std::max(longest, label.size());
  const bool slanted = static_cast<double>(longest) * 6.5 > slot;
  const double below = slanted ? std::min(120.0, 4.6 * static_cast<double>(longest)) : 0;
  const std::size_t beside = chart.stacked ? 1 : chart.series.size();
  const double width = std::min(34.0, slot * 0.8 / static_cast<double>(beside));
  std::string out =
      chart_head(chart.title, chart.unit, lines_height(chart) + below) + axis_marks(nullptr, y, "");
  std::vector<double> base(chart.labels.size(), 0.0);
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const auto& series = chart.series[s];
    const char* ink = chart_ink(series.ink.value_or(s));
    for (std::size_t i = 0; i < series.y.size() && i < chart.labels.size(); ++i) {
      const double value = series.y[i];
      if (!(value > 0)) continue;
      const double from = chart.stacked ? base[i]
                          : y.log       ? y.low
                                        : 0,
                   to = chart.stacked ? base[i] + value : value;
      base[i] = to;
      const double x =
          kChartLeft + slot * (static_cast<double>(i) + 0.5) +
          width * (chart.stacked ? -0.5 : static_cast<double>(s) - static_cast<double>(beside) / 2);
      out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>",
                         x, y.at(to), width - 1, std::max(0.0, y.at(from) - y.at(to)), ink);
    }
    auto [column, row] = legend_place(s);
    row += below;
    out += fmt::format(
        "\n<rect x=\"{}\" y=\"{}\" width=\"12\" height=\"12\" fill=\"{}\"/><text x=\"{}\" "
        "y=\"{}\">{}</text>\n",
        column, row - 10, ink, column + 18, row, markup_text(series.label));
  }
  for (std::size_t i = 0; i < chart.labels.size(); ++i) {
    const double x = kChartLeft + slot * (static_cast<double>(i) + 0.5);
    out += fmt::format("<text transform=\"translate({:.1f} {}){}\" text-anchor=\"{}\">{}</text>\n", x,
                       kBottom + 17, slanted ? " rotate(-35)" : "", slanted ? "end" : "middle",
                       markup_text(chart.labels[i]));
  }
  return out + "</svg>\n";
}

}  // namespace

std::string chart_svg(const Chart& chart) {
  return chart.map ? map_svg(chart) : chart.labels.empty() ? lines_svg(chart) : bars_svg(chart);
}

}  // namespace palpate
