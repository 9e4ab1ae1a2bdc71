#include "model/path_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <string_view>

#include "model/generate/turn.h"
#include "model/rotation.h"

namespace palpate {
namespace {

constexpr std::string_view kFreeHeader = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage";
constexpr std::string_view kGuidedHeader = "time_s,travel_m,rx_rad,ry_rad,rz_rad,stage";
constexpr std::string_view kGuideHeader = "travel_m,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr double kFarthest = 1e4;   ///< m; a scene is below 100 m or warned about

std::string printed(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// A value as it stands in the file, short enough and plain enough for a sentence.
std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > 40 ? "…\"" : "\"");
}

struct Row {
  std::string place;             ///< "path.csv, line 3"
  std::vector<double> values;    ///< as many as the header has names
};

/// All rows below the header, each checked to have as many finite numbers as the header has names.
Result<std::vector<Row>> read_table(const std::string& file, std::string_view header) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad_value(file + " cannot be opened");
  const auto columns = static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;
  std::vector<Row> rows;
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);
      if (line != header)
        return bad_value(file + ": the first line is " + quoted(line) + "; it must be \"" + std::string(header) + "\"");
      continue;
    }
    if (line.empty()) continue;
    Row row{file + ", line " + std::to_string(number), {}};
    const std::string& place = row.place;
    std::string_view rest = line;
    for (bool more = true; more;) {
      const std::size_t comma = rest.find(',');
      std::string_view cell = rest.substr(0, comma);
      more = comma != std::string_view::npos;
      if (more) rest.remove_prefix(comma + 1);
      while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
      while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
      double value = 0;
      const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
        return bad_value(place + ": " + quoted(cell) + " is not a finite number");
      row.values.push_back(value);
    }
    if (row.values.size() != columns)
      return bad_value(place + " has " + std::to_string(row.values.size()) + " values; it must have " + std::to_string(columns));
    rows.push_back(std::move(row));
  }
  if (in.bad()) return bad_value(file + " cannot be read");
  return rows;
}

/// x y z qx qy qz qw.
Result<Pose> pose_from(std::span<const double> values, const std::string& place) {
  Pose pose{{values[0], values[1], values[2]}, Quat(values[6], values[3], values[4], values[5])};
  for (int k = 0; k < 3; ++k)
    if (std::abs(pose.position[k]) > kFarthest)
      return bad_value(place + ": position " + printed(pose.position[k]) + " m is beyond 10000 m");
  const double square = values[3] * values[3] + values[4] * values[4] + values[5] * values[5] + values[6] * values[6];
  if (!(std::abs(square - 1) <= kUnitQuaternionTolerance))
    return bad_value(place + ": the rotation's length is " + printed(std::sqrt(square)) + "; a unit quaternion has length 1");
  pose.rotation = pose.rotation / std::sqrt(square);
  return pose;
}

Result<int> stage_from(double value, const std::string& place) {
  if (value < 0 || value > 1e6 || value != std::floor(value))
    return bad_value(place + ": stage " + printed(value) + " is not a whole number from 0 to 1000000");
  return static_cast<int>(value);
}

void add_pose(std::string& out, const Pose& pose) {
  for (const double value : {pose.position.x, pose.position.y, pose.position.z, pose.rotation.x, pose.rotation.y,
                             pose.rotation.z, pose.rotation.w})
    out += ',' + printed(value);
}

}  // namespace

Result<std::vector<PathPoint>> read_path(const std::string& file, bool guided) {
  const auto rows = read_table(file, guided ? kGuidedHeader : kFreeHeader);
  if (!rows) return rows.error();
  if (rows->empty()) return bad_value(file + " has no point");
  std::vector<PathPoint> path;
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const auto& [place, row] = (*rows)[i];
    PathPoint point;
    point.time_s = row[0];
    if (point.time_s < 0 || (i > 0 && point.time_s <= path.back().time_s))
      return bad_value(place + ": time " + printed(point.time_s) + " s must be " +
                       (i > 0 ? "above the one before, " + printed(path.back().time_s) + " s" : "0 or more"));
    const auto stage = stage_from(row.back(), place);
    if (!stage) return stage.error();
    point.stage = *stage;
    if (guided) {
      if (std::abs(row[1]) > kFarthest) return bad_value(place + ": travel " + printed(row[1]) + " m is beyond 10000 m");
      for (int k = 2; k < 5; ++k)
        if (std::abs(row[static_cast<std::size_t>(k)]) > 2 * kPi)
          return bad_value(place + ": rotation " + printed(row[static_cast<std::size_t>(k)]) + " rad is beyond a whole turn");
      point.travel_m = row[1];
      point.pose = {{row[1], 0, 0}, rotation_about(Vec3(row[2], row[3], row[4]))};
    } else {
      const auto pose = pose_from(std::span(row).subspan(1, 7), place);
      if (!pose) return pose.error();
      point.pose = *pose;
    }
    path.push_back(point);
  }
  return path;
}

Result<std::vector<GuidePoint>> read_guide(const std::string& file) {
  const auto rows = read_table(file, kGuideHeader);
  if (!rows) return rows.error();
  if (rows->size() < 2) return bad_value(file + " has fewer than two points; a guide is a curve");
  std::vector<GuidePoint> guide;
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const auto& [place, row] = (*rows)[i];
    if (i > 0 && row[0] <= guide.back().travel_m)
      return bad_value(place + ": travel " + printed(row[0]) + " m must be above the one before, " +
                       printed(guide.back().travel_m) + " m");
    const auto pose = pose_from(std::span(row).subspan(1, 7), place);
    if (!pose) return pose.error();
    guide.push_back({row[0], *pose});
  }
  return guide;
}

std::string path_text(const std::vector<PathPoint>& path, bool guided) {
  std::string out(guided ? kGuidedHeader : kFreeHeader);
  out += '\n';
  for (const PathPoint& point : path) {
    out += printed(point.time_s);
    if (guided) {
      const Vec3 turn = rotation_vector(point.pose.rotation);
      for (const double value : {point.travel_m, turn.x, turn.y, turn.z}) out += ',' + printed(value);
    } else {
      add_pose(out, point.pose);
    }
    out += ',' + std::to_string(point.stage) + '\n';
  }
  return out;
}

std::string guide_text(const std::vector<GuidePoint>& guide) {
  std::string out(kGuideHeader);
  out += '\n';
  for (const GuidePoint& point : guide) {
    out += printed(point.travel_m);
    add_pose(out, point.frame);
    out += '\n';
  }
  return out;
}

Pose guide_frame(const std::vector<GuidePoint>& guide, double travel_m) {
  if (travel_m <= guide.front().travel_m) return guide.front().frame;
  if (travel_m >= guide.back().travel_m) return guide.back().frame;
  const auto after = std::upper_bound(guide.begin(), guide.end(), travel_m,
                                      [](double travel, const GuidePoint& point) { return travel < point.travel_m; });
  const GuidePoint &a = *(after - 1), &b = *after;
  const double share = (travel_m - a.travel_m) / (b.travel_m - a.travel_m);
  const Vec3 turn = rotation_vector(b.frame.rotation * glm::conjugate(a.frame.rotation));
  return {a.frame.position + share * (b.frame.position - a.frame.position),
          glm::normalize(rotation_about(share * turn) * a.frame.rotation)};
}

Pose path_pose(const PathPoint& point, const std::vector<GuidePoint>& guide) {
  if (guide.empty()) return point.pose;
  const Pose frame = guide_frame(guide, point.travel_m);
  return {frame.position, glm::normalize(frame.rotation * point.pose.rotation)};
}

}  // namespace palpate
