#include "model/files/path_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string_view>

#include "model/files/csv_file.h"
#include "model/generate/turn.h"
#include "model/lattice/rotation.h"

namespace palpate {
namespace {

constexpr std::string_view kFreeHeader = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage";
constexpr std::string_view kGuidedHeader = "time_s,travel_m,rx_rad,ry_rad,rz_rad,stage";
constexpr std::string_view kGuideHeader = "travel_m,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr std::string_view kUntimedHeader = "x,y,z,qx,qy,qz,qw";  ///< of poses that a planner writes
constexpr double kLongestTravel = 1e4;  ///< m of travel; a scene is below 100 m or warned about

Result<Pose> unit_pose(const CsvRow& row) {
  auto pose = row.pose(1);
  if (pose) pose->rotation = pose->rotation / glm::length(pose->rotation);
  return pose;
}

/// travel_m, rx_rad, ry_rad, rz_rad from the second column on.
Result<PathPoint> guided_point(const CsvRow& row) {
  double values[4];
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = row.number(i + 1);
    if (!value) return value.error();
    values[i] = *value;
    if (i == 0 && std::abs(*value) > kLongestTravel)
      return bad_value(row.place() + ": travel " + printed(*value) + " m is beyond 10000 m");
    if (i > 0 && std::abs(*value) > 2 * kPi)
      return bad_value(row.place() + ": rotation " + printed(*value) + " rad is beyond a whole turn");
  }
  PathPoint point;
  point.travel_m = values[0];
  point.pose = {{values[0], 0, 0}, rotation_about(Vec3(values[1], values[2], values[3]))};
  return point;
}

/// Without a byte order mark and the end of the line; empty where there is none.
std::string first_line(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::getline(in, line);
  if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

void add_pose(std::string& out, const Pose& pose) {
  for (const double value : {pose.position.x, pose.position.y, pose.position.z, pose.rotation.x,
                             pose.rotation.y, pose.rotation.z, pose.rotation.w})
    out += ',' + printed(value);
}

}  // namespace

Result<std::vector<PathPoint>> read_path(const std::string& file, bool guided) {
  std::vector<PathPoint> path;
  const auto take = [&](const CsvRow& row) -> Result<void> {
    PathPoint point;
    if (guided) {
      const auto read = guided_point(row);
      if (!read) return read.error();
      point = *read;
    } else {
      const auto pose = unit_pose(row);
      if (!pose) return pose.error();
      point.pose = *pose;
    }
    const auto time = row.time(0);
    if (!time) return time.error();
    if (!path.empty() && *time <= path.back().time_s)
      return bad_value(row.place() + ": time " + printed(*time) + " s must be above the one before, " +
                       printed(path.back().time_s) + " s");
    const auto stage = row.stage(row.size() - 1);
    if (!stage) return stage.error();
    point.time_s = *time;
    point.stage = *stage;
    path.push_back(point);
    return {};
  };
  if (auto read = read_csv(file, {guided ? kGuidedHeader : kFreeHeader}, nullptr, take); !read) {
    Error fault = read.error();
    if (first_line(file).starts_with(kUntimedHeader))
      fault.sentence += " (poses without times are for \"query\" and \"path\")";
    return fault;
  }
  if (path.empty()) return bad_value(file + " has no point");
  return path;
}

std::optional<bool> guided_header(const std::string& file) {
  const std::string header = first_line(file);
  if (header == kGuidedHeader) return true;
  if (header == kFreeHeader) return false;
  return std::nullopt;
}

Result<std::vector<GuidePoint>> read_guide(const std::string& file) {
  std::vector<GuidePoint> guide;
  const auto take = [&](const CsvRow& row) -> Result<void> {
    const auto travel = row.number(0);
    if (!travel) return travel.error();
    if (!guide.empty() && *travel <= guide.back().travel_m)
      return bad_value(row.place() + ": travel " + printed(*travel) + " m must be above the one before, " +
                       printed(guide.back().travel_m) + " m");
    const auto pose = unit_pose(row);
    if (!pose) return pose.error();
    guide.push_back({*travel, *pose});
    return {};
  };
  if (auto read = read_csv(file, {kGuideHeader}, nullptr, take); !read) return read.error();
  if (guide.size() < 2) return bad_value(file + " has fewer than two points; a guide is a curve");
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
  const auto after =
      std::upper_bound(guide.begin(), guide.end(), travel_m,
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
