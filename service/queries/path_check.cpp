#include "service/queries/path_check.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "model/lattice/screw.h"
#include "service/queries/query_json.h"
#include "service/queries/touched_parts.h"

namespace palpate {
namespace {

void unite(std::vector<std::string>& all, const std::vector<std::string>& more) {
  for (const std::string& name : more)
    if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
}

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
  const double step = geometry.lattice.step_m;
  const std::int32_t within = within_steps(geometry, within_m);
  const TouchedParts named(geometry);
  PathReport out;
  out.rule = rule;
  Contacts contacts;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!progress("poses", static_cast<double>(i) / static_cast<double>(poses.size())))
      return Error{ErrorCode::kInternal, "interrupted"};
    PathMoment moment;
    moment.pose = poses[i];
    const auto lattice = to_lattice(poses[i], geometry);
    if (!lattice) return lattice.error();
    if (auto done = backend.clearance(*lattice, within, moment.clearance); !done) return done.error();
    ++out.evaluations;
    if (moment.clearance.kind == Clearance::Kind::kTouching) {
      if (auto done = backend.query(*lattice, nullptr, contacts); !done) return done.error();
      if (contacts.truncated)
        return Error{ErrorCode::kInternal,
                     std::string("a frame had too little room for ") + contacts.truncated_capacity};
      moment.depth_m = contacts.field.max_depth * step;
      moment.touches =
          rule.tolerance == 0 || contacts.field.max_depth > static_cast<std::uint32_t>(rule.tolerance);
      if (!moment.touches) {
        ++out.tolerated;
        if (contacts.field.max_depth == 0) ++out.without_depth;
      }
      if (contacts.field.max_depth > 0) {
        moment.static_part = part_of(geometry.mockup_report, contacts.field.deepest_static);
        moment.tool_part = part_of(geometry.tool_report, contacts.field.deepest_mobile);
      } else if (!contacts.cst.empty()) {
        moment.static_part = part_of(geometry.mockup_report, contacts.cst.front());
        moment.tool_part = part_of(geometry.tool_report, contacts.cmt.front());
      }
      const std::uint32_t place = contacts.field.max_depth > 0 ? contacts.field.deepest_mobile
                                  : !contacts.cmt.empty()      ? contacts.cmt.front()
                                                               : kNoTriangle;
      if (place != kNoTriangle) {
        const LatticeMesh& tool = geometry.tool;
        const Vec3 a(transform(*lattice, tool.corner(place, 0))),
            b(transform(*lattice, tool.corner(place, 1))), c(transform(*lattice, tool.corner(place, 2)));
        moment.where = geometry.lattice.origin_m + step / 3 * (a + b + c);
        moment.facing = glm::cross(b - a, c - a);
      }
      if (moment.touches) {
        unite(out.static_parts, named.statics(contacts));
        unite(out.tool_parts, named.mobiles(contacts));
      }
      if (!out.deepest || *moment.depth_m > *out.moments[*out.deepest].depth_m) out.deepest = i;
    } else if (moment.clearance.kind == Clearance::Kind::kApart) {
      moment.static_part = part_of(geometry.mockup_report, moment.clearance.static_id);
      moment.tool_part = part_of(geometry.tool_report, moment.clearance.mobile_id);
      if (!out.closest || moment.clearance.steps < out.moments[*out.closest].clearance.steps) out.closest = i;
    }
    if (i == 0) {
      if (moment.touches) moment.first_contact = 0;
    } else {
      const Vec3 tool_from = poses[i - 1].rotation * geometry.tool_centre_m + poses[i - 1].position,
                 tool_to = poses[i].rotation * geometry.tool_centre_m + poses[i].position;
      moment.travel_m = out.moments.back().travel_m + glm::length(tool_to - tool_from);
      const auto contact = first_contact(backend, geometry, poses[i - 1], poses[i], rule);
      if (!contact) return contact.error();
      ++out.screws;
      out.evaluations += contact->evaluations;
      moment.undecided = contact->kind == FirstContact::Kind::kUndecided;
      if (contact->kind != FirstContact::Kind::kNone) moment.first_contact = contact->time;
      if (moment.first_contact && contact->static_id != kNoTriangle) {
        const std::string fixed = part_of(geometry.mockup_report, contact->static_id),
                          moved = part_of(geometry.tool_report, contact->mobile_id);
        if (!fixed.empty()) unite(out.static_parts, {fixed});
        if (!moved.empty()) unite(out.tool_parts, {moved});
        if (!out.first_screw) {
          out.first_static = fixed;
          out.first_tool = moved;
        }
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
