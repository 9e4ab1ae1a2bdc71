#include "service/queries/path_check.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "model/lattice/screw.h"
#include "service/queries/query_json.h"
#include "service/queries/side_by_side.h"
#include "service/queries/touched_parts.h"

namespace palpate {
namespace {

void unite(std::vector<std::string>& all, const std::vector<std::string>& more) {
  for (const std::string& name : more)
    if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
}

/// What one pose and the screw that ends there say for themselves.
struct Examined {
  PathMoment moment;
  std::optional<FirstContact> contact;  ///< none: it is the first pose
  std::string come_static, come_tool;   ///< parts that come together on the screw; empty: nobody knows
  std::vector<std::string> static_parts, tool_parts;  ///< that touch at the pose
};

/// Asks about the poses of a path, in any order.
class PathExaminer {
 public:
  PathExaminer(const SceneGeometry& geometry, const std::vector<Pose>& poses, const TouchRule& rule,
               std::int32_t within)
      : geometry_(geometry), poses_(poses), rule_(rule), within_(within), named_(geometry) {}

  Result<void> examine(CollisionBackend& backend, std::size_t i, Examined& out) const {
    out.moment.pose = poses_[i];
    const auto lattice = to_lattice(poses_[i], geometry_);
    if (!lattice) return lattice.error();
    if (auto done = backend.clearance(*lattice, within_, out.moment.clearance); !done) return done.error();
    const Clearance& clearance = out.moment.clearance;
    if (clearance.kind == Clearance::Kind::kTouching) {
      if (auto done = touching(backend, *lattice, out); !done) return done;
    } else if (clearance.kind == Clearance::Kind::kApart) {
      out.moment.static_part = part_of(geometry_.mockup_report, clearance.static_id);
      out.moment.tool_part = part_of(geometry_.tool_report, clearance.mobile_id);
    }
    return i == 0 ? Result<void>() : come_from(backend, i, out);
  }

 private:
  /// What touches at the pose, how deep and where.
  Result<void> touching(CollisionBackend& backend, const LatticePose& lattice, Examined& out) const {
    PathMoment& moment = out.moment;
    Contacts contacts;
    if (auto done = backend.query(lattice, nullptr, contacts); !done) return done.error();
    if (contacts.truncated)
      return Error{ErrorCode::kInternal,
                   std::string("a frame had too little room for ") + contacts.truncated_capacity};
    const double step = geometry_.lattice.step_m;
    const std::uint32_t depth = contacts.field.max_depth;
    moment.depth_m = depth * step;
    moment.touches = rule_.tolerance == 0 || depth > static_cast<std::uint32_t>(rule_.tolerance);
    if (depth > 0) {
      moment.static_part = part_of(geometry_.mockup_report, contacts.field.deepest_static);
      moment.tool_part = part_of(geometry_.tool_report, contacts.field.deepest_mobile);
    } else if (!contacts.cst.empty()) {
      moment.static_part = part_of(geometry_.mockup_report, contacts.cst.front());
      moment.tool_part = part_of(geometry_.tool_report, contacts.cmt.front());
    }
    const std::uint32_t place = depth > 0               ? contacts.field.deepest_mobile
                                : !contacts.cmt.empty() ? contacts.cmt.front()
                                                        : kNoTriangle;
    if (place != kNoTriangle) {
      const LatticeMesh& tool = geometry_.tool;
      const Vec3 a(transform(lattice, tool.corner(place, 0))), b(transform(lattice, tool.corner(place, 1))),
          c(transform(lattice, tool.corner(place, 2)));
      moment.where = geometry_.lattice.origin_m + step / 3 * (a + b + c);
      moment.facing = glm::cross(b - a, c - a);
    }
    if (moment.touches) {
      out.static_parts = named_.statics(contacts);
      out.tool_parts = named_.mobiles(contacts);
    }
    return {};
  }

  /// The first contact on the way from the pose before.
  Result<void> come_from(CollisionBackend& backend, std::size_t i, Examined& out) const {
    const auto contact = first_contact(backend, geometry_, poses_[i - 1], poses_[i], rule_);
    if (!contact) return contact.error();
    out.contact = *contact;
    out.moment.undecided = contact->kind == FirstContact::Kind::kUndecided;
    if (contact->kind == FirstContact::Kind::kNone) return {};
    out.moment.first_contact = contact->time;
    if (contact->static_id == kNoTriangle) return {};
    out.come_static = part_of(geometry_.mockup_report, contact->static_id);
    out.come_tool = part_of(geometry_.tool_report, contact->mobile_id);
    return {};
  }

  const SceneGeometry& geometry_;
  const std::vector<Pose>& poses_;
  const TouchRule& rule_;
  std::int32_t within_;
  const TouchedParts named_;
};

}  // namespace

std::string part_of(const MeshReport& report, std::uint32_t triangle) {
  std::uint64_t end = 0;
  for (const MeshReport::Part& part : report.parts)
    if (triangle < (end += part.triangles)) return part.path;
  return "";
}

Result<PathReport> check_path(const LoadedScene& scene, CollisionBackend& backend,
                              const std::vector<Pose>& poses, const TouchRule& rule,
                              std::optional<double> within_m, const Progress& progress) {
  if (poses.empty()) return bad_value("the path has no pose, so nothing was examined");
  const SceneGeometry& geometry = scene.geometry;
  const PathExaminer examiner(geometry, poses, rule, within_steps(geometry, within_m));
  std::vector<Examined> examined(poses.size());
  const auto done = Fellows(backend).ask(
      poses.size(),
      [&](CollisionBackend& asked, std::size_t i) { return examiner.examine(asked, i, examined[i]); },
      [&](std::size_t begun) {
        return progress("poses", static_cast<double>(begun) / static_cast<double>(poses.size()));
      });
  if (!done) return done.error();
  if (*done < poses.size()) return Error{ErrorCode::kInternal, "interrupted"};

  PathReport out;
  out.rule = rule;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    PathMoment moment = std::move(examined[i].moment);
    ++out.evaluations;
    unite(out.static_parts, examined[i].static_parts);
    unite(out.tool_parts, examined[i].tool_parts);
    if (moment.clearance.kind == Clearance::Kind::kTouching) {
      if (!moment.touches) {
        ++out.tolerated;
        if (*moment.depth_m == 0) ++out.without_depth;
      }
      if (!out.deepest || *moment.depth_m > *out.moments[*out.deepest].depth_m) out.deepest = i;
    } else if (moment.clearance.kind == Clearance::Kind::kApart) {
      if (!out.closest || moment.clearance.steps < out.moments[*out.closest].clearance.steps) out.closest = i;
    }
    if (i == 0) {
      if (moment.touches) moment.first_contact = 0;
    } else {
      const Vec3 tool_from = poses[i - 1].rotation * geometry.tool_centre_m + poses[i - 1].position,
                 tool_to = poses[i].rotation * geometry.tool_centre_m + poses[i].position;
      moment.travel_m = out.moments.back().travel_m + glm::length(tool_to - tool_from);
      ++out.screws;
      out.evaluations += examined[i].contact->evaluations;
      const std::string &fixed = examined[i].come_static, &moved = examined[i].come_tool;
      if (!fixed.empty()) unite(out.static_parts, {fixed});
      if (!moved.empty()) unite(out.tool_parts, {moved});
      if (moment.first_contact && !out.first_screw) {
        out.first_static = fixed;
        out.first_tool = moved;
      }
      // The screw's end is rounded once more by itself: a pose that touches is no clear one.
      if (moment.touches && !moment.first_contact) moment.first_contact = 1;
    }
    if (moment.first_contact && !out.first_screw) {
      out.first_screw = i;
      out.first_time = *moment.first_contact;
      out.first_pose = i == 0 ? poses[0] : Screw(poses[i - 1], poses[i], geometry).at(out.first_time);
      if (out.first_static.empty()) {
        out.first_static = moment.static_part;
        out.first_tool = moment.tool_part;
      }
    }
    out.moments.push_back(std::move(moment));
  }
  return out;
}

}  // namespace palpate
