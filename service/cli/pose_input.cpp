#include "service/cli/pose_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "model/files/one_line.h"
#include "model/files/path_file.h"
#include "model/scene/scene_file.h"
#include "model/scene/scene_geometry.h"

namespace palpate {
namespace {

constexpr std::array<const char*, 7> kFields = {"x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::string_view kHeader = "x,y,z,qx,qy,qz,qw";
/// Of a scene's path and a run's trace, which have further columns.
constexpr std::string_view kTimedHeader = "time_s,x_m,y_m,z_m,qx,qy,qz,qw";

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// A value as a sentence may show it.
std::string shown(std::string_view text) {
  return one_line(std::string(text.substr(0, 80))) + (text.size() > 80 ? "…" : "");
}

/// A field to a number; the error names the field, not the file.
Result<double> to_number(std::string_view text, const char* name) {
  std::string_view field = trim(text);
  if (field.size() > 1 && field.front() == '+') field.remove_prefix(1);  // from_chars knows no plus sign
  double value = 0;
  const char* end = field.data() + field.size();
  const auto [stop, error] = std::from_chars(field.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end)
    return bad_value(fmt::format("has {} '{}', which is beyond a double", name, shown(field)));
  if (error != std::errc() || stop != end)
    return bad_value(fmt::format("has {} '{}', which is not a number", name, shown(field)));
  return value;
}

/// Seven fields to a pose; the error says which field, without naming the file.
Result<Pose> to_pose(const std::vector<std::string_view>& fields) {
  if (fields.size() != kFields.size())
    return bad_value(fmt::format("has {} values instead of 7 (x y z qx qy qz qw)", fields.size()));
  std::array<double, 7> value{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const Result<double> number = to_number(fields[i], kFields[i]);
    if (!number) return number.error();
    value[i] = *number;
  }
  return pose_of(value);
}

/// The pose of a line of a path or trace, after its time.
Result<Pose> to_timed_pose(const std::vector<std::string_view>& fields, std::size_t columns) {
  if (fields.size() != columns)
    return bad_value(fmt::format("has {} values instead of the header's {}", fields.size(), columns));
  const Result<double> time = to_number(fields[0], "time_s");
  if (!time) return time.error();
  if (!std::isfinite(*time))
    return bad_value(fmt::format("has time_s '{}', which is not finite", shown(trim(fields[0]))));
  return to_pose({fields.begin() + 1, fields.begin() + 1 + kFields.size()});
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators, bool merge) {
  std::vector<std::string_view> fields;
  while (true) {
    const auto end = text.find_first_of(separators);
    const std::string_view field = text.substr(0, end);
    if (!merge || !field.empty()) fields.push_back(field);
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

Result<Pose> pose_of(const std::array<double, 7>& value) {
  Pose pose;
  pose.position = Vec3(value[0], value[1], value[2]);
  pose.rotation = Quat(value[6], value[3], value[4], value[5]);
  // Whether it is a pose does not depend on the scene, so any lattice tells; a bad one is refused before
  // meshes are read.
  SceneGeometry any;
  any.lattice.step_m = 1;
  const Result<LatticePose> lattice = to_lattice(pose, any);
  if (!lattice) return bad_value("is no pose: " + lattice.error().sentence);
  return pose;
}

Result<Pose> parse_pose(const std::string& text) {
  Result<Pose> pose = to_pose(split(text, " ,\t\n\r", true));
  if (!pose) return bad_value(fmt::format("--pose \"{}\" {}", shown(text), pose.error().sentence));
  return pose;
}

Result<std::vector<Pose>> read_poses(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown))
    return bad_value(fmt::format("{}: a folder is no poses file", path));
  std::ifstream in(path);
  if (!in) return bad_value(fmt::format("{}: the poses file can't be opened", path));
  return read_poses(in, path);
}

Result<std::vector<Pose>> read_poses_of_scene(const std::string& path, const std::string& scene_file) {
  // What can be read once alone, such as a pipe, is not asked for its header first.
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown) || !guided_header(path).value_or(false))
    return read_poses(path);
  const auto points = read_path(path, true);
  if (!points) return points.error();
  const auto scene = read_scene(scene_file);
  if (!scene) return scene.error();
  if (scene->device.guide.empty())
    return bad_value(fmt::format("{}: the path is along a guide, and {} names none", path, scene_file));
  std::vector<Pose> out;
  for (const PathPoint& point : *points) out.push_back(path_pose(point, scene->device.guide));
  return out;
}

Result<std::vector<Pose>> read_poses(std::istream& in, const std::string& path) {
  std::string text;
  const bool begun = static_cast<bool>(std::getline(in, text));
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  const std::string header(trim(text));
  const bool timed = header == kTimedHeader || header.starts_with(std::string(kTimedHeader) + ",");
  if (!begun || (header != kHeader && !timed))
    return bad_value(
        fmt::format("{}, line 1: the header is '{}' instead of '{}', nor does it begin with '{}'", path,
                    shown(header), kHeader, kTimedHeader));
  const auto columns = static_cast<std::size_t>(std::ranges::count(header, ',')) + 1;

  std::vector<Pose> poses;
  std::string first_error;
  std::size_t bad_lines = 0;
  for (std::size_t line = 2; std::getline(in, text); ++line) {
    const std::string_view row = trim(text);
    if (row.empty()) continue;
    Result<Pose> pose =
        timed ? to_timed_pose(split(row, ",", false), columns) : to_pose(split(row, ",", false));
    if (pose)
      poses.push_back(*pose);
    else if (bad_lines++ == 0)
      first_error = fmt::format("{}, line {}: it {}", path, line, pose.error().sentence);
  }
  if (in.bad()) return bad_value(fmt::format("{}: reading the poses file failed", path));
  if (bad_lines > 1) first_error += fmt::format(" ({} lines are bad)", bad_lines);
  if (bad_lines > 0) return bad_value(std::move(first_error));
  if (poses.empty()) return bad_value(fmt::format("{}: the poses file has no pose", path));
  return poses;
}

}  // namespace palpate
