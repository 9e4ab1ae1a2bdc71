#include "service/queries/first_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/lattice/screw.h"

namespace palpate {
namespace {

constexpr double kEarly = 1e-6;  // m

/// How far the tool's sphere is from the grid's box, steps; no less than 0. The mock-up is two voxels further
/// in.
double beyond(const SceneGeometry& geometry, const Pose& pose) {
  const VoxelGrid& grid = geometry.mockup_grid;
  const Vec3 centre = (pose.rotation * geometry.tool_centre_m + pose.position - geometry.lattice.origin_m) /
                      geometry.lattice.step_m;
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double low = grid.origin[k],
                 high = low + static_cast<double>(grid.size) * kBrickSide * grid.bricks[k];
    const double away = std::max({low - centre[k], centre[k] - high, 0.0});
    sum += away * away;
  }
  return std::max(std::sqrt(sum) - geometry.tool_radius, 0.0);
}

/// For how long the tool may go on from a pose with a tolerance: neither a distance nor a depth changes
/// faster than its fastest point moves.
Result<FreeTime> free_time_with_tolerance(CollisionBackend& backend, const LatticePose& pose, double speed,
                                          double longest, const TouchRule& rule) {
  const auto touch = touch_at(backend, pose, rule);
  if (!touch) return touch.error();
  FreeTime out{.time = longest};
  double room = rule.tolerance - kMotionSlack;  // steps
  if (touch->depth >= 0) {
    room -= static_cast<double>(touch->depth);
    out.static_id = touch->static_id;
    out.mobile_id = touch->mobile_id;
  } else {
    Clearance near;
    const double reach = std::min(std::max(speed * longest - room, 0.0) + 1, 0x1p30);
    if (auto done = backend.clearance(pose, static_cast<std::int32_t>(reach), near); !done)
      return done.error();
    if (near.kind == Clearance::Kind::kFurther) return out;
    room += near.steps;
    out = {.time = longest, .steps = near.steps, .static_id = near.static_id, .mobile_id = near.mobile_id};
  }
  const double time = touch->touches ? 0 : std::max(room, 0.0) / speed;
  if (time >= longest) return FreeTime{.time = longest};
  out.time = time;
  out.blocked = true;
  return out;
}

}  // namespace

TouchRule TouchRule::of(const SceneGeometry& geometry, double tolerance_m) {
  const double step = geometry.lattice.step_m;
  const auto steps = [&](double m) { return static_cast<std::int32_t>(std::min(m / step, 0x1p29)); };
  return {.tolerance = steps(tolerance_m), .early = std::max(steps(kEarly), 16)};
}

Result<Touch> touch_at(CollisionBackend& backend, const LatticePose& pose, const TouchRule& rule) {
  std::uint8_t bit = 0;
  if (auto done = backend.touches({&pose, 1}, {&bit, 1}); !done) return done.error();
  if (bit == 0 || rule.tolerance == 0) return Touch{bit != 0, -1};
  Contacts contacts;
  if (auto done = backend.query(pose, nullptr, contacts); !done) return done.error();
  if (contacts.truncated)
    return Error{ErrorCode::kInternal,
                 std::string("a frame had too little room for ") + contacts.truncated_capacity};
  const FieldSums& field = contacts.field;
  Touch out{field.max_depth > static_cast<std::uint32_t>(rule.tolerance), field.max_depth};
  if (field.max_depth > 0) out.static_id = field.deepest_static, out.mobile_id = field.deepest_mobile;
  return out;
}

Result<FirstContact> first_contact(CollisionBackend& backend, const SceneGeometry& geometry, const Pose& from,
                                   const Pose& to, const TouchRule& rule) {
  for (const Pose* end : {&from, &to})
    if (const auto lattice = to_lattice(*end, geometry); !lattice) return lattice.error();
  ScrewMotion motion(Screw(from, to, geometry));
  const Screw& screw = motion.screw;
  const double speed = screw.length();
  FirstContact out{.time = 0};
  while (out.evaluations < kMostSteps) {
    const Pose pose = screw.at(out.time);
    const auto lattice = to_lattice(pose, geometry);
    if (!lattice) return lattice.error();
    const double longest = 1 - out.time;
    ++out.evaluations;
    FreeTime free;
    if (lattice->beyond_lattice) {
      free.time = speed > 0
                      ? (beyond(geometry, pose) + 2.0 * geometry.mockup_grid.size - kMotionSlack) / speed
                      : longest;
      if (free.time >= longest)
        free.time = longest;
      else
        free.blocked = true,
        free.steps = std::numeric_limits<std::int32_t>::max();  // by the end of what is known
    } else if (rule.tolerance > 0) {
      const auto found = free_time_with_tolerance(backend, *lattice, speed, longest, rule);
      if (!found) return found.error();
      free = *found;
      free.steps = free.time * speed <= rule.early ? 0 : rule.early + 1;  // of depth, too
    } else {
      if (out.evaluations == 1) {  // later nothing gets in without its triangles meeting
        const auto touch = touch_at(backend, *lattice, rule);
        if (!touch) return touch.error();
        if (touch->touches) {
          out.kind = FirstContact::Kind::kContact;
          return out;
        }
      }
      if (auto done = backend.free_time(*lattice, motion, out.time, free); !done) return done.error();
    }
    if (!free.blocked) {
      out.time = 1;
      return out;
    }
    out.steps = free.steps;
    out.static_id = free.static_id;
    out.mobile_id = free.mobile_id;
    // A pair so near that goes on apart, or along, ends nothing.
    if (free.steps <= rule.early && free.time * speed <= rule.early) {
      out.kind = FirstContact::Kind::kContact;
      return out;
    }
    const double next = out.time + free.time;
    if (!(next > out.time)) break;  // less than a double can tell
    out.time = next;
  }
  out.kind = FirstContact::Kind::kUndecided;
  return out;
}

}  // namespace palpate
