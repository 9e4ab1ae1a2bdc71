#include "service/server/queries/pose_body.h"

#include <array>
#include <bit>
#include <cstring>
#include <sstream>

#include "service/cli/pose_input.h"
#include "service/server/http/http_message.h"
#include "service/server/http/json_input.h"

namespace palpate {
namespace {

constexpr std::size_t kPoseBytes = 7 * sizeof(double);
static_assert(std::endian::native == std::endian::little, "binary forms are little-endian");

std::variant<Pose, Problem> checked(const std::array<double, 7>& values, const std::string& field) {
  const Result<Pose> pose = pose_of(values);
  if (!pose) return bad_request(field + " " + pose.error().sentence, field);
  return *pose;
}

Problem too_many(std::size_t count, const ServerLimits& limits) {
  return {413, "too-large",
          "there are " + std::to_string(count) + " poses, and the limit is " + std::to_string(limits.poses),
          "poses"};
}

std::variant<std::vector<Pose>, Problem> from_json(const std::string& body, const ServerLimits& limits) {
  const auto read = read_json_object(body, limits.json_depth, {"poses", "pose"});
  if (const auto* problem = std::get_if<Problem>(&read)) return *problem;
  const auto& json = std::get<nlohmann::json>(read);
  if (json.contains("pose") == json.contains("poses"))
    return bad_request("either \"pose\" or \"poses\" is wanted", "poses");
  std::vector<Pose> poses;
  const auto take = [&](const nlohmann::json& value, const std::string& field) -> std::optional<Problem> {
    const auto pose = pose_from_json(value, field);
    if (const auto* problem = std::get_if<Problem>(&pose)) return *problem;
    poses.push_back(std::get<Pose>(pose));
    return std::nullopt;
  };
  if (json.contains("pose")) {
    if (auto problem = take(json["pose"], "pose")) return *problem;
    return poses;
  }
  const nlohmann::json& list = json["poses"];
  if (!list.is_array()) return bad_request("\"poses\" is no list of poses", "poses");
  if (list.empty()) return bad_request("\"poses\" has no pose, and at least one is wanted", "poses");
  if (list.size() > limits.poses) return too_many(list.size(), limits);
  for (std::size_t i = 0; i < list.size(); ++i)
    if (auto problem = take(list[i], "poses[" + std::to_string(i) + "]")) return *problem;
  return poses;
}

}  // namespace

std::variant<Pose, Problem> pose_from_json(const nlohmann::json& value, const std::string& field) {
  std::array<double, 7> values{};
  if (!value.is_array() || value.size() != values.size())
    return bad_request(field + " is no list of 7 numbers (x y z qx qy qz qw)", field);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!value[i].is_number())
      return bad_request(field + " is no list of 7 numbers (x y z qx qy qz qw)", field);
    values[i] = value[i].get<double>();
  }
  return checked(values, field);
}

std::variant<Pose, Problem> pose_from_bytes(const char* bytes, const std::string& field) {
  std::array<double, 7> values{};
  std::memcpy(values.data(), bytes, kPoseBytes);
  return checked(values, field);
}

std::variant<std::vector<Pose>, Problem> read_pose_body(std::string_view content_type,
                                                        const std::string& body, const ServerLimits& limits) {
  const std::string type = media_type(content_type);
  if (type == "application/json") return from_json(body, limits);
  std::vector<Pose> poses;
  if (type == "text/csv") {
    std::istringstream in(body);
    Result<std::vector<Pose>> read = read_poses(in, "body");
    if (!read) return bad_request(read.error().sentence, "body");
    poses = std::move(*read);
  } else if (type == "application/vnd.palpate.poses") {
    if (body.empty()) return bad_request("the body has no pose, and at least one is wanted", "body");
    if (body.size() % kPoseBytes != 0)
      return bad_request(
          "the body has " + std::to_string(body.size()) + " bytes, no multiple of 56 (7 doubles a pose)",
          "body");
    if (body.size() / kPoseBytes > limits.poses) return too_many(body.size() / kPoseBytes, limits);
    for (std::size_t at = 0; at < body.size(); at += kPoseBytes) {
      const auto pose = pose_from_bytes(body.data() + at, "poses[" + std::to_string(at / kPoseBytes) + "]");
      if (const auto* problem = std::get_if<Problem>(&pose)) return *problem;
      poses.push_back(std::get<Pose>(pose));
    }
  } else {
    return Problem{415, "media-type",
                   "poses come as text/csv, application/json or application/vnd.palpate.poses, not as '" +
                       shown_text(type) + "'",
                   "Content-Type"};
  }
  if (poses.size() > limits.poses) return too_many(poses.size(), limits);
  return poses;
}

}  // namespace palpate
