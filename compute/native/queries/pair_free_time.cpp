#include <glm/gtc/quaternion.hpp>

#include "compute/native/queries/pair_soonest.h"

namespace palpate::native {

/// The tool's lattice frame in the world's at a time of a screw, not rounded.
struct PairSearch::Placed {
  Vec column[3], at;
  Placed(const Screw& screw, double time, const SceneGeometry& geometry) {
    const Pose pose = screw.at(time);
    const glm::dmat3 turn = glm::mat3_cast(pose.rotation);
    for (int c = 0; c < 3; ++c) column[c] = vec(turn[c]);
    at = vec((turn * geometry.tool_centre_m + pose.position - geometry.lattice.origin_m) /
             geometry.lattice.step_m);
  }
  /// Of a point of the tool, from its lattice origin.
  Vec turned(const Vec& p) const { return column[0] * p[0] + column[1] * p[1] + column[2] * p[2]; }
};

/// All of the tool on a screw, in spheres, each by itself as far as it is free for certain.
struct PairSearch::Followed final : ScrewMotion::Learned {
  /// What is in a sphere of the tool.
  struct Part {
    double time;                  ///< it meets nothing before
    std::uint32_t level, number;  ///< of ToolSpheres; level 1 at least: a run
    double speed;                 ///< of its fastest point, at most; steps a unit of time
    bool blocked = false;         ///< at `time`, by a pair that was `steps` apart at `asked_at`
    double asked_at = 0;
    std::int32_t steps = 0;
    std::uint32_t static_id = kNoTriangle, mobile_id = kNoTriangle;
  };

  explicit Followed(const Screw& along) : screw(along) {}
  static bool later(const Part& a, const Part& b) { return a.time > b.time; }
  const Part& first() const { return parts.front(); }
  void push(const Part& part) {
    parts.push_back(part);
    std::push_heap(parts.begin(), parts.end(), later);
  }
  /// The first part, which is taken out; at a time where it is no further ahead.
  Part pop(double time) {
    std::pop_heap(parts.begin(), parts.end(), later);
    Part out = parts.back();
    parts.pop_back();
    if (out.time < time + kSameTime) out.time = time;
    return out;
  }
  /// A part meets nothing for so many steps.
  void step(Part part, double steps) {
    const double time = part.time + steps / part.speed * (1 - 0x1p-40);
    if (!(time > part.time + kSameTime)) return stop(part);  // little more than doubles can tell
    part.time = time;
    part.blocked = false;
    push(part);
  }
  /// Whether it goes on from here cannot be known.
  void stop(Part part) {
    part.blocked = true;
    part.asked_at = part.time;
    part.steps = std::numeric_limits<std::int32_t>::max();
    push(part);
  }

  const Screw screw;
  std::vector<Part> parts;  ///< a heap, that first which is least far ahead
};

/// A sphere of a level above 0. One of the only run of a small tool is that about all of the tool.
PairSearch::Sphere PairSearch::sphere(std::uint32_t level, std::uint32_t number) const {
  if (level > trees_->spheres.top()) return {{}, static_cast<double>(trees_->geometry->tool_radius)};
  const EightSpheres& eight = trees_->spheres.group(level, number / kWide);
  const std::size_t i = number % kWide;
  return {{static_cast<double>(eight.centre[0][i]), static_cast<double>(eight.centre[1][i]),
           static_cast<double>(eight.centre[2][i])},
          static_cast<double>(eight.radius[i])};
}

/// Begins with all of the tool at a time.
void PairSearch::follow(Followed& followed, double time) const {
  const std::uint32_t level = std::max(trees_->spheres.top(), 1U);
  auto count = static_cast<std::uint32_t>((trees_->tool.order.size() + kWide - 1) / kWide);
  for (std::uint32_t below = 1; below < level; ++below) count = (count + kWide - 1) / kWide;
  push_spheres(followed, level, 0, count, time);
}

/// `count` spheres from `first` on, each free until a time.
void PairSearch::push_spheres(Followed& followed, std::uint32_t level, std::uint32_t first,
                              std::uint32_t count, double time) const {
  const Twist twist = followed.screw.twist(time);
  const Placed placed(followed.screw, time, *trees_->geometry);
  const Vec axis = vec(twist.axis);
  for (std::uint32_t number = first; number < first + count; ++number) {
    const Sphere own = sphere(level, number);
    if (own.centre[0] == static_cast<double>(kNoSphere)) return;
    // Along the axis all points are as fast, across it by how far they are from it; a screw keeps both.
    const Vec v = vec(twist.velocity) + cross(axis, placed.turned(own.centre)) * twist.angle;
    const double along = dot(v, axis), across = length(v - axis * along) + twist.angle * own.radius;
    followed.push({.time = time,
                   .level = level,
                   .number = number,
                   .speed = std::sqrt(along * along + across * across)});
  }
}

/// The first part goes on from `time`, or from its own where that is later: a sphere by the room that it has,
/// or its parts do; of a run the triangles are asked.
void PairSearch::go_on(Followed& followed, double time) {
  Followed::Part part = followed.pop(time);
  const RoomField& field = trees_->field;
  const Sphere own = sphere(part.level, part.number);
  if (!part.blocked) {
    const Placed placed(followed.screw, part.time, *trees_->geometry);
    const double room = field.room_at(placed.at + placed.turned(own.centre)) - own.radius - kMotionSlack;
    if (room > kWorthAStep * std::max(own.radius, field.cell_steps())) return followed.step(part, room);
    if (part.level > 1) return push_spheres(followed, part.level - 1, kWide * part.number, kWide, part.time);
  }
  const auto pose = to_lattice(followed.screw.at(part.time), *trees_->geometry);
  if (!pose || pose->beyond_lattice) return followed.stop(part);
  begin(*pose);
  const double reach = kReach * (own.radius + field.cell_steps());
  const Twist twist = followed.screw.twist(part.time);
  Timed policy{*this, vec(twist.axis), vec(twist.velocity), vec(pose->translation), twist.angle,
               0,     part.speed};
  policy.set(std::min(reach / part.speed, 1 - part.time));
  Lead lead{std::numeric_limits<double>::infinity(), part.number, 0, {}};
  const EightSpheres& triangles = trees_->spheres.group(0, part.number);
  EightFloats squared;
  field.rooms(turn_, triangles, squared);
  for (std::uint32_t i = 0; i < kWide; ++i) {
    lead.rooms[i] = field.room(turn_, squared[i], triangles.radius[i]);
    lead.room = std::min(lead.room, lead.rooms[i]);
    if (policy.within(lead.rooms[i])) lead.mask |= 1u << i;
  }
  if (lead.mask == 0) return followed.step(part, lead.room - kMotionSlack);
  descend(policy, lead);
  if (!policy.out.blocked) return followed.step(part, reach);
  part.blocked = true;
  part.asked_at = part.time;
  part.time += policy.time;
  part.steps = policy.out.steps;
  part.static_id = policy.out.static_id;
  part.mobile_id = policy.out.mobile_id;
  followed.push(part);
}

/// Each part of the tool is followed by itself for as long as it is free, that first which is least far
/// ahead: a part with much room is asked about seldom, and nothing is asked about after the first contact.
FreeTime PairSearch::free_time(ScrewMotion& motion, double time) {
  if (trees_->tool.order.empty() || trees_->mockup.order.empty()) return {.time = 1 - time};
  auto* followed = dynamic_cast<Followed*>(motion.learned.get());
  if (followed == nullptr) {
    auto fresh = std::make_unique<Followed>(motion.screw);
    follow(*fresh, time);
    followed = fresh.get();
    motion.learned = std::move(fresh);
  }
  while (followed->first().time < 1) {
    const Followed::Part& first = followed->first();
    if (first.blocked && first.asked_at >= time)
      return {.time = std::max(first.time - time, 0.0),
              .blocked = true,
              // How far apart they are at this time; of a later one nothing is promised.
              .steps = first.asked_at == time ? first.steps : std::numeric_limits<std::int32_t>::max(),
              .static_id = first.static_id,
              .mobile_id = first.mobile_id};
    go_on(*followed, time);
  }
  return {.time = 1 - time};
}

}  // namespace palpate::native
