#include "service/bench/error/error_charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace palpate {
namespace {

constexpr const char* kNames[] = {"d", "n_c", "cp", "F", "T"};
constexpr const char* kUnits[] = {"m", "°", "m", "N", "N·m"};
constexpr double kMillisecond = 1000;  // µs

const char* method_of(const ErrorPoint& point) {
  return point.setting.profile == Profile::kPaper ? "paper" : "refined";
}

Chart::Marker marker_of(const std::string& knob) {
  return knob == "sample_spacing"    ? Chart::Marker::kCircle
         : knob == "voxel_size"      ? Chart::Marker::kSquare
         : knob == "contact_samples" ? Chart::Marker::kDiamond
                                     : Chart::Marker::kTriangle;
}

/// Millimetres of what is a length, else a number.
std::string value_text(const ErrorSetting& setting) {
  if (setting.knob == "sample_spacing" || setting.knob == "voxel_size")
    return fmt::format("{:.3g}", 1000 * setting.value);
  return setting.value >= 10000 ? fmt::format("{:.3g}k", setting.value / 1000)
                                : fmt::format("{:g}", setting.value);
}

const char* knob_unit(const std::string& knob) {
  return knob == "sample_spacing" || knob == "voxel_size" ? " mm" : "";
}

double error_of(const ErrorPoint& point, std::size_t quantity, double fraction) {
  return percentile(point.result.errors[quantity], fraction);
}

/// As the charts have it: F and T in hundredths of the truth's median.
double shown(const ErrorPoint& point, const ErrorTruths& truths, std::size_t quantity, double fraction) {
  return relative_error(point, truths, quantity, fraction) * (quantity >= 3 ? 100 : 1);
}

std::string unit_of(std::size_t quantity) {
  return quantity >= 3 ? fmt::format("% of the median |{}|", kNames[quantity]) : kUnits[quantity];
}

std::vector<std::pair<double, double>> over_spacing(const ErrorCurves& curves, std::size_t quantity,
                                                    double fraction) {
  std::vector<std::pair<double, double>> out;
  for (const ErrorPoint& point : curves.points)
    if (point.setting.knob == "sample_spacing")
      out.emplace_back(point.setting.value, error_of(point, quantity, fraction));
  std::sort(out.begin(), out.end());
  return out;
}

std::string truth_text(const ErrorCurves& curves, const ErrorTruths& truths, std::size_t quantity) {
  if (!truths.spacing_m) return truths.about + ".";
  const auto curve = over_spacing(curves, quantity, 0.5);
  const auto fit = fitted_order(curve);
  if (!fit || curve.front().second <= 0 || fit->order <= 0)
    return truths.about + "; its own error can't be told from these spacings.";
  return fmt::format(
      "{}; by the order fitted here it is itself off by {:.2g} {} at the median.", truths.about,
      own_error(curve.front().second, curve.front().first, *truths.spacing_m, fit->order), kUnits[quantity]);
}

}  // namespace

double relative_error(const ErrorPoint& point, const ErrorTruths& truths, std::size_t quantity,
                      double fraction) {
  const double error = error_of(point, quantity, fraction);
  if (quantity < 3) return error;
  return error / truths.typical[point.setting.profile == Profile::kPaper ? 1 : 0][quantity];
}

std::optional<FittedOrder> fitted_order(const std::vector<std::pair<double, double>>& curve) {
  double n = 0, sx = 0, sy = 0;
  for (const auto& [value, error] : curve)
    if (error > 0) n += 1, sx += std::log(value), sy += std::log(error);
  if (n < 3) return std::nullopt;
  double sxx = 0, sxy = 0, syy = 0;
  for (const auto& [value, error] : curve) {
    if (!(error > 0)) continue;
    const double x = std::log(value) - sx / n, y = std::log(error) - sy / n;
    sxx += x * x, sxy += x * y, syy += y * y;
  }
  if (!(sxx > 0)) return std::nullopt;
  // Student's t for a two-sided 95 %, by degrees of freedom from 1 on; beyond the table the normal's.
  constexpr double kStudent[] = {12.71, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  FittedOrder out{sxy / sxx, 0, static_cast<std::size_t>(n)};
  const auto freedom = static_cast<std::size_t>(n) - 2;
  const double rest = std::max(0.0, syy - out.order * sxy);
  const double student = freedom <= std::size(kStudent) ? kStudent[freedom - 1] : 1.96;
  out.half_width = student * std::sqrt(rest / static_cast<double>(freedom) / sxx);
  return out;
}

std::string order_text(const FittedOrder& fit, const char* what) {
  return fmt::format("{:.2f} ± {:.2f} over {} {}", fit.order, fit.half_width, fit.points, what);
}

double own_error(double finest_error, double finest_spacing, double truth_spacing, double order) {
  const double rest = std::pow(truth_spacing / finest_spacing, order);
  return rest < 1 ? finest_error * rest / (1 - rest) : HUGE_VAL;
}

Chart error_time_chart(const std::string& subject, const ErrorCurves& curves, const ErrorTruths& truths,
                       std::size_t quantity) {
  Chart chart{.title = fmt::format("{}, engine {}: error of {} against time", subject, curves.engine,
                                   kNames[quantity]),
              .unit = unit_of(quantity),
              .labels = {},
              .series = {},
              .log_x = true,
              .log_y = true,
              .x_title = "median time of a frame, µs"};
  chart.rules = {{kMillisecond, "1 ms"}};
  chart.group = subject;
  chart.y_most = 10 * truths.largest[quantity];
  if (quantity >= 3) chart.y_most *= 100 / truths.typical[0][quantity];
  bool diverged = false;
  for (const double fraction : {0.5, 0.99})
    for (const ErrorPoint& point : curves.points) {
      const std::string label = fmt::format("{}, {}{}, p{:.0f}", method_of(point), point.setting.knob,
                                            knob_unit(point.setting.knob), 100 * fraction);
      auto series = std::find_if(chart.series.begin(), chart.series.end(),
                                 [&](const auto& s) { return s.label == label; });
      if (series == chart.series.end()) {
        Chart::Series fresh{.label = label, .x = {}, .y = {}};
        fresh.ink = point.setting.profile == Profile::kPaper ? 2 : 0;
        fresh.marker = marker_of(point.setting.knob);
        fresh.dashed = fraction > 0.5;
        series = chart.series.insert(series, fresh);
      }
      const double error = shown(point, truths, quantity, fraction);
      if (!(error > 0)) continue;  // a logarithm has no place for it
      diverged = diverged || !(error <= chart.y_most);
      series->x.push_back(percentile(point.result.times_us, 0.5));
      series->y.push_back(error);
      series->names.push_back(fraction == 0.5 ? value_text(point.setting) : "");
    }
  // What no other setting beats in both.
  std::vector<std::pair<double, double>> medians;
  for (const ErrorPoint& point : curves.points)
    if (const double error = shown(point, truths, quantity, 0.5); error > 0 && error <= chart.y_most)
      medians.emplace_back(percentile(point.result.times_us, 0.5), error);
  std::sort(medians.begin(), medians.end());
  Chart::Series front{.label = "Pareto front of the medians", .x = {}, .y = {}};
  front.guide = true;
  front.marker = Chart::Marker::kNone;
  for (const auto& [us, error] : medians)
    if (front.y.empty() || error < front.y.back()) {
      if (!front.y.empty()) front.x.push_back(us), front.y.push_back(front.y.back());
      front.x.push_back(us), front.y.push_back(error);
    }
  chart.series.push_back(std::move(front));
  const std::size_t poses = curves.points.empty() ? 0 : curves.points.front().result.times_us.size();
  chart.caption = fmt::format(
      "{} poses in contact. Blue: refined, red: paper; a marker a knob, its value beside it; whole lines "
      "medians, dashed "
      "lines p99 of the errors, both over the median time. {}{}",
      poses, truth_text(curves, truths, quantity),
      diverged ? " Open triangles at the upper edge: off by more than ten times the truth's largest." : "");
  return chart;
}

Chart convergence_chart(const std::string& subject, const ErrorCurves& curves, const ErrorTruths& truths,
                        std::size_t quantity) {
  Chart chart{.title = fmt::format("{}: convergence of {}", subject, kNames[quantity]),
              .unit = kUnits[quantity],
              .labels = {},
              .series = {},
              .log_x = true,
              .log_y = true,
              .x_title = "sample spacing h, mm"};
  chart.group = subject;
  std::string orders;
  double coarsest = 0, from = 0, to = HUGE_VAL;
  for (const double fraction : {0.5, 0.99}) {
    const auto curve = over_spacing(curves, quantity, fraction);
    Chart::Series series{.label = fmt::format("refined, p{:.0f}", 100 * fraction), .x = {}, .y = {}};
    series.ink = 0;
    series.dashed = fraction > 0.5;
    for (const auto& [spacing, error] : curve) {
      if (!(error > 0)) continue;
      series.x.push_back(1000 * spacing);
      series.y.push_back(error);
      from = std::max(from, 1000 * spacing), to = std::min(to, 1000 * spacing);
      if (fraction == 0.5) coarsest = error;
    }
    if (const auto fit = fitted_order(curve))
      orders += fmt::format("{}p{:.0f} falls with order {}", orders.empty() ? "" : ", ", 100 * fraction,
                            order_text(*fit, "spacings"));
    chart.series.push_back(std::move(series));
  }
  if (coarsest > 0)
    for (const int slope : {1, 2}) {
      Chart::Series guide{.label = fmt::format("order {}", slope), .x = {from, to}, .y = {}};
      guide.guide = guide.dashed = true;
      guide.marker = Chart::Marker::kNone;
      guide.y = {coarsest, coarsest * std::pow(to / from, slope)};
      chart.series.push_back(std::move(guide));
    }
  chart.caption =
      (orders.empty() ? "" : "The error of " + orders + " (95 %). ") + truth_text(curves, truths, quantity);
  return chart;
}

Chart engines_chart(const std::string& subject, const std::vector<ErrorCurves>& engines) {
  Chart chart{.title = subject + ": engines, refined over the sample spacing",
              .unit = "error of F, p50, N",
              .labels = {},
              .series = {},
              .log_x = true,
              .log_y = true,
              .x_title = "median time of a frame, µs"};
  chart.rules = {{kMillisecond, "1 ms"}};
  chart.group = subject;
  for (const ErrorCurves& curves : engines) {
    Chart::Series series{.label = curves.engine, .x = {}, .y = {}};
    for (const ErrorPoint& point : curves.points) {
      if (point.setting.knob != "sample_spacing") continue;
      series.x.push_back(percentile(point.result.times_us, 0.5));
      series.y.push_back(error_of(point, 3, 0.5));
      series.names.push_back(value_text(point.setting));
    }
    chart.series.push_back(std::move(series));
  }
  chart.caption =
      "All engines give the same bits, so that only times differ: the curves are the same one, moved "
      "sideways. Beside "
      "the points the spacing in mm.";
  return chart;
}

}  // namespace palpate
