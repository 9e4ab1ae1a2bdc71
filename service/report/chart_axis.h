#pragma once
#include <cmath>
#include <string>
#include <vector>

namespace palpate {

/// One axis of a chart: from values to places in the picture.
struct ChartAxis {
  double low = HUGE_VAL, high = -HUGE_VAL, from = 0, to = 1;
  bool log = false;

  /// Makes room for a value.
  void hold(double value);
  /// After the last value: whole decades, or 0 among what is shown.
  void settle();
  double at(double value) const;
  std::vector<double> ticks() const;
};

/// A tick's number: three digits, thousands in full ("20,000"), an exponent from a million on.
std::string tick_text(double value);

/// The beginning of a picture: ground, title and unit.
std::string chart_head(const std::string& title, const std::string& unit, double height);

inline constexpr double kChartWidth = 760, kChartLeft = 86, kChartRight = 34, kChartTop = 40,
                        kChartPlot = 330;

/// Colour of a series, from its number.
const char* chart_ink(std::size_t number);
std::size_t chart_inks();

}  // namespace palpate
