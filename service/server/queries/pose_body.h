#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "model/lattice/pose.h"
#include "service/server/http/limits.h"
#include "service/server/http/problem.h"

namespace palpate {

/// The poses of a query's body (docs/SERVICE.md): CSV, JSON or doubles, by `content_type`. At least one, at
/// most limits.poses; each is a pose.
std::variant<std::vector<Pose>, Problem> read_pose_body(std::string_view content_type,
                                                        const std::string& body, const ServerLimits& limits);

/// [x, y, z, qx, qy, qz, qw]; `field` names it in a refusal.
std::variant<Pose, Problem> pose_from_json(const nlohmann::json& value, const std::string& field);

/// Seven doubles, little-endian, not aligned.
std::variant<Pose, Problem> pose_from_bytes(const char* bytes, const std::string& field);

}  // namespace palpate
