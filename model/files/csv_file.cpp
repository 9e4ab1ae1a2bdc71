#include "model/files/csv_file.h"

#include <charconv>
#include <cmath>
#include <fstream>

namespace palpate {
namespace {

constexpr double kFarthest = 1e4;  // m
constexpr double kLatest = 1e6;    // s: eleven days

/// A piece of the file, short enough and plain enough for a sentence.
std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 40 ? "…\"" : "\"");
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (bool more = true; more;) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    more = comma != std::string_view::npos;
    if (more) line.remove_prefix(comma + 1);
    while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
    while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
    cells.push_back(cell);
  }
  return cells;
}

bool begins(std::string_view line, const CsvHeader& header) {
  if (line == header.columns) return true;
  return header.more && line.starts_with(header.columns) && line[header.columns.size()] == ',';
}

}  // namespace

std::string printed(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

Result<double> CsvRow::number(std::size_t column) const {
  const std::string_view cell = cells_[column];
  std::string_view digits = cell;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-')
    digits.remove_prefix(1);  // from_chars knows none
  double value = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    return bad_value(place() + ": " + in_quotes(cell) + " is not a finite number");
  return value;
}

Result<double> CsvRow::time(std::size_t column) const {
  auto value = number(column);
  if (value && (*value < 0 || *value > kLatest))
    return bad_value(place() + ": time " + printed(*value) + " s is not from 0 to 1000000 s");
  return value;
}

Result<int> CsvRow::stage(std::size_t column) const {
  const auto value = number(column);
  if (!value) return value.error();
  if (*value < 0 || *value > 1e6 || *value != std::floor(*value))
    return bad_value(place() + ": stage " + printed(*value) + " is not a whole number from 0 to 1000000");
  return static_cast<int>(*value);
}

Result<Pose> CsvRow::pose(std::size_t column) const {
  double values[7];
  for (std::size_t i = 0; i < 7; ++i) {
    const auto value = number(column + i);
    if (!value) return value.error();
    values[i] = *value;
    if (i < 3 && std::abs(*value) > kFarthest)
      return bad_value(place() + ": position " + printed(*value) + " m is beyond 10000 m");
  }
  const double square =
      values[3] * values[3] + values[4] * values[4] + values[5] * values[5] + values[6] * values[6];
  if (!(std::abs(square - 1) <= kUnitQuaternionTolerance))
    return bad_value(place() + ": the rotation's length is " + printed(std::sqrt(square)) +
                     "; a unit quaternion has length 1");
  return Pose{{values[0], values[1], values[2]}, Quat(values[6], values[3], values[4], values[5])};
}

Result<void> read_csv(const std::string& file, const CsvHeader& header,
                      const std::function<void(const std::vector<std::string_view>& names)>& names,
                      const std::function<Result<void>(const CsvRow& row)>& take) {
  const std::string wanted =
      (header.more ? "it must begin with \"" : "it must be \"") + std::string(header.columns) + "\"";
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad_value(file + " cannot be opened");
  std::string line;
  std::size_t columns = 0;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
      if (!begins(line, header)) return bad_value(file + ", line 1 is " + in_quotes(line) + "; " + wanted);
      const std::vector<std::string_view> found = cells_of(line);
      columns = found.size();
      if (names) names(found);
      continue;
    }
    if (line.empty()) continue;
    const CsvRow row(file, number, cells_of(line));
    if (row.size() != columns)
      return bad_value(row.place() + " has " + std::to_string(row.size()) + " values; the header has " +
                       std::to_string(columns));
    if (Result<void> taken = take(row); !taken) return taken.error();
  }
  if (in.bad() || (columns == 0 && !in.eof())) return bad_value(file + " cannot be read");
  if (columns == 0) return bad_value(file + ", line 1 is missing; " + wanted);
  return {};
}

}  // namespace palpate
