#include "driver/replay/trace_file.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "model/files/csv_file.h"

namespace palpate::replay {
namespace {

constexpr CsvHeader kHeader{"time_s,x_m,y_m,z_m,qx,qy,qz,qw", true};
constexpr std::size_t kMostRows = 24 * 3600 * 1000;  // a day of ticks, 7 GB: beyond that it is no recording

}  // namespace

Result<std::vector<TraceRow>> read_trace(const std::string& file) {
  std::optional<std::size_t> stage_column;
  std::vector<TraceRow> rows;
  const auto names = [&](const std::vector<std::string_view>& found) {
    if (const auto at = std::find(found.begin(), found.end(), "stage"); at != found.end())
      stage_column = static_cast<std::size_t>(at - found.begin());
  };
  const auto take = [&](const CsvRow& row) -> Result<void> {
    const auto time = row.time(0);
    if (!time) return time.error();
    const auto pose = row.pose(1);
    if (!pose) return pose.error();
    const Result<int> stage = stage_column ? row.stage(*stage_column) : 0;
    if (!stage) return stage.error();
    if (!rows.empty() && *time <= rows.back().time_s)
      return bad_value(row.place() + ": time " + printed(*time) + " s must be above the one before, " +
                       printed(rows.back().time_s) + " s");
    if (rows.size() == kMostRows)
      return bad_value(row.place() + ": a trace has at most " + std::to_string(kMostRows) +
                       " rows, a day of them");
    rows.push_back({*time, *pose, *stage});
    return {};
  };
  if (auto read = read_csv(file, kHeader, names, take); !read) return read.error();
  if (rows.empty()) return bad_value(file + " has no row below its header");
  return rows;
}

}  // namespace palpate::replay
