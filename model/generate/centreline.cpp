#include "model/generate/centreline.h"

#include <glm/geometric.hpp>

#include "model/generate/turn.h"

namespace palpate {
namespace {

Pose along(const Centreline::Part& part, double distance) {
  Vec3 moved(distance, 0, 0);
  Quat turned(1, 0, 0, 0);
  if (part.radius > 0) {
    const double angle = distance / part.radius;
    const Turn t = turn_rad(angle);
    moved = Vec3(part.radius * t.sin, 0, 0) + part.side * (part.radius * (1 - t.cos));
    turned = rotation_about(glm::cross(Vec3(1, 0, 0), part.side), angle);
  }
  return {part.frame.position + part.frame.rotation * moved, part.frame.rotation * turned};
}

}  // namespace

void Centreline::straight(double length) {
  parts_.push_back({length_, length, frame(length_), Vec3(0), 0});
  length_ += length;
}

void Centreline::bend(const Vec3& side, double angle, double radius) {
  parts_.push_back({length_, angle * radius, frame(length_), side, radius});
  length_ += angle * radius;
}

Pose Centreline::frame(double s) const {
  if (parts_.empty()) return {Vec3(s, 0, 0), Quat(1, 0, 0, 0)};
  for (const Part& part : parts_)
    if (s < part.start + part.length && (s >= 0 || part.radius == 0)) return along(part, s - part.start);
  Part beyond{length_, 0, along(parts_.back(), parts_.back().length), Vec3(0), 0};
  return along(beyond, s - length_);
}

}  // namespace palpate
