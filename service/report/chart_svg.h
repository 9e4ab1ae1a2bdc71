#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A picture of the report. Bars: `labels` and a value a label in each series' y. Lines: points (x, y). A
/// map: `labels` are its columns, each series a row of it, the colour of a cell the logarithm of its value.
struct Chart {
  enum class Marker : std::uint8_t { kCircle, kSquare, kTriangle, kDiamond, kCross, kNone };
  struct Series {
    std::string label;
    std::vector<double> x, y;
    bool expected = false;  ///< lines: what theory says of the series before it, in its ink, dashed
    std::optional<std::size_t> ink{};  ///< number of a colour; empty: the series' own
    Marker marker = Marker::kCircle;
    bool dashed = false, line = true;  ///< line false: markers alone
    bool guide = false;                ///< thin and grey: a slope to compare with
    std::vector<std::string> names{};  ///< beside the points, one each; may be empty
  };
  struct Rule {
    double x = 0;
    std::string label;
  };
  std::string title, unit;
  std::vector<std::string> labels;  ///< empty: lines
  std::vector<Series> series;
  bool stacked = false, log_x = false, log_y = false;
  std::string x_title, y_title = {};  ///< y_title: of a map
  bool map = false;
  double map_low = 0, map_high = 0;  ///< of a map's colours; 0: from its values
  std::string caption = {};          ///< below it in the report: what is shown, and how it is meant
  std::vector<Rule> rules = {};      ///< upright lines
  double y_most = 0;  ///< what lies above is marked at the upper edge, as diverged; 0: everything is shown
  std::string group = {};  ///< chapter of the report that it stands in; empty: none
};

/// A chart as a picture by itself, for documents.
std::string chart_svg(const Chart& chart);

}  // namespace palpate
