#include "driver/replay/trace_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include "driver/limits.h"

namespace palpate::replay {
namespace {

constexpr std::string_view kColumns = "time_s,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr std::size_t kUsed = 8;                     // of the columns above
constexpr std::size_t kMostRows = 24 * 3600 * 1000;  // a day of ticks, 7 GB: beyond that it is no recording
constexpr double kLatest = 1e6;                      // s
constexpr double kFarthest = 1e4;                    // m

std::string printed(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// A piece of the file, short enough and plain enough for a sentence.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 40 ? "…\"" : "\"");
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t comma = 0; comma != std::string_view::npos; line.remove_prefix(comma + 1)) {
    comma = line.find(',');
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) break;
  }
  return cells;
}

std::optional<double> number_in(std::string_view cell) {
  double value = 0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Where the column `stage` stands, and how many there are.
struct Header {
  std::size_t columns = 0;
  std::optional<std::size_t> stage;
};

Result<Header> header_of(const std::string& file, std::string_view line) {
  if (line.rfind("\xEF\xBB\xBF", 0) == 0) line.remove_prefix(3);
  if (line != kColumns && line.rfind(std::string(kColumns) + ',', 0) != 0)
    return bad_value(file + ", line 1 is " + quoted(line) + "; a trace begins with \"" + std::string(kColumns) + "\"");
  const std::vector<std::string_view> names = cells_of(line);
  Header header{names.size(), {}};
  if (const auto found = std::find(names.begin(), names.end(), "stage"); found != names.end())
    header.stage = static_cast<std::size_t>(found - names.begin());
  return header;
}

Result<TraceRow> row_of(const std::string& place, std::string_view line, const Header& header) {
  const std::vector<std::string_view> cells = cells_of(line);
  if (cells.size() != header.columns)
    return bad_value(place + " has " + std::to_string(cells.size()) + " values; the header has " + std::to_string(header.columns));
  double used[kUsed] = {};
  for (std::size_t i = 0; i < kUsed; ++i) {
    const auto value = number_in(cells[i]);
    if (!value) return bad_value(place + ": " + quoted(cells[i]) + " is not a finite number");
    used[i] = *value;
  }
  TraceRow row{used[0], {Vec3(used[1], used[2], used[3]), Quat(used[7], used[4], used[5], used[6])}, 0};
  if (row.time_s < 0 || row.time_s > kLatest) return bad_value(place + ": time " + printed(row.time_s) + " s is not from 0 to 1000000 s");
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(row.pose.position[axis]) > kFarthest)
      return bad_value(place + ": position " + printed(row.pose.position[axis]) + " m is beyond 10000 m");
  if (!sound(row.pose))
    return bad_value(place + ": the rotation's length is " + printed(std::hypot(std::hypot(used[4], used[5]), std::hypot(used[6], used[7]))) +
                     "; a unit quaternion has length 1");
  if (header.stage) {
    const auto stage = number_in(cells[*header.stage]);
    if (!stage || *stage < 0 || *stage > 1e6 || *stage != std::floor(*stage))
      return bad_value(place + ": stage " + quoted(cells[*header.stage]) + " is not a whole number from 0 to 1000000");
    row.stage = static_cast<int>(*stage);
  }
  return row;
}

}  // namespace

Result<std::vector<TraceRow>> read_trace(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad_value(file + ": the recorded trace can't be opened");
  std::string line;
  Header header;
  std::vector<TraceRow> rows;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      auto read = header_of(file, line);
      if (!read) return read.error();
      header = *read;
      continue;
    }
    if (line.empty()) continue;
    const std::string place = file + ", line " + std::to_string(number);
    auto row = row_of(place, line, header);
    if (!row) return row.error();
    if (!rows.empty() && row->time_s <= rows.back().time_s)
      return bad_value(place + ": time " + printed(row->time_s) + " s must be above the one before, " + printed(rows.back().time_s) + " s");
    if (rows.size() == kMostRows) return bad_value(place + ": a trace has at most " + std::to_string(kMostRows) + " rows, a day of them");
    rows.push_back(*row);
  }
  if (in.bad() || (header.columns == 0 && !in.eof())) return bad_value(file + ": the recorded trace can't be read");
  if (header.columns == 0) return bad_value(file + ", line 1 is missing; a trace begins with \"" + std::string(kColumns) + "\"");
  if (rows.empty()) return bad_value(file + " has no row below its header");
  return rows;
}

}  // namespace palpate::replay
