#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "model/scene/scene.h"
#include "service/queries/first_contact.h"

namespace palpate {

/// One pose of a path.
struct PathMoment {
  Pose pose;
  Clearance clearance;            ///< kTouching: also where the contact is no deeper than the tolerance
  bool touches = false;           ///< under the rule
  std::optional<double> depth_m;  ///< in contact: how deep the deepest sample lies
  std::optional<Vec3> where;  ///< in contact: a place of it, world, m: the middle of the tool triangle that
                              ///< is deepest, or of one that meets another
  Vec3 facing{0};             ///< there: the triangle's normal
  std::string static_part,
      tool_part;        ///< nearest to each other; in contact of the deepest samples; empty: nobody knows
  double travel_m = 0;  ///< of the tool's origin until here
  std::optional<double> first_contact;  ///< from 0 to 1, on the screw from the pose before; empty: clear, or
                                        ///< there is none before
  bool undecided = false;               ///< FirstContact::Kind::kUndecided there
};

/// A path, examined pose by pose and screw by screw.
struct PathReport {
  std::vector<PathMoment> moments;
  TouchRule rule;
  std::optional<std::size_t>
      first_screw;                 ///< that is not clear: it ends at this moment; 0: the first pose touches
  double first_time = 0;           ///< on it
  std::optional<Pose> first_pose;  ///< there
  std::string first_static, first_tool;  ///< parts that come together there
  std::optional<std::size_t> closest;    ///< moment with the least clearance of those that are apart
  std::optional<std::size_t> deepest;    ///< moment with the greatest depth
  std::vector<std::string> static_parts,
      tool_parts;                   ///< that touch at a pose, or come together first on a screw
  std::uint64_t tolerated = 0;      ///< poses whose contact does not count
  std::uint64_t without_depth = 0;  ///< of these, where no sample lies in the other body
  std::uint64_t screws = 0, evaluations = 0;
  /// Whether the tool touches nowhere.
  bool clear() const { return !first_screw; }
};

/// Asks for every pose's clearance and for the first contact of every screw between two that follow each
/// other. `within_m`: further distances are not measured. Errors: no pose, a pose that is none, the back
/// end's, interrupted.
Result<PathReport> check_path(const LoadedScene& scene, CollisionBackend& backend,
                              const std::vector<Pose>& poses, const TouchRule& rule,
                              std::optional<double> within_m, const Progress& progress);

/// The part of a body that has a triangle, by its path; empty: the triangle is in none.
std::string part_of(const MeshReport& report, std::uint32_t triangle);

}  // namespace palpate
