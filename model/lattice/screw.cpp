#include "model/lattice/screw.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

/// sin(t x) / sin x, t in [0, 1], x up to π/2.
double share_of_sine(double t, double x) { return x < 1e-8 ? t : std::sin(t * x) / std::sin(x); }

}  // namespace

Screw::Screw(const Pose& from, const Pose& to, const SceneGeometry& geometry)
    : start_(glm::normalize(from.rotation)),
      tool_centre_(geometry.tool_centre_m),
      step_m_(geometry.lattice.step_m),
      radius_(geometry.tool_radius) {
  const Vec3 turn = rotation_vector(glm::normalize(glm::normalize(to.rotation) * glm::conjugate(start_)));
  origin_ = start_ * tool_centre_ + from.position;
  const Vec3 way = glm::normalize(to.rotation) * tool_centre_ + to.position - origin_;
  angle_ = glm::length(turn);
  if (angle_ > 0) axis_ = turn / angle_;
  along_ = axis_ * glm::dot(axis_, way);
  across_ = way - along_;
}

Vec3 Screw::turned(const Vec3& way, double angle) const {
  return way * std::cos(angle) + glm::cross(axis_, way) * std::sin(angle);
}

// Across the axis the origin runs on an arc over the chord from 0 to 1, which is seen under the angle θ. The
// chord from 0 to t has the share sin(tθ/2) / sin(θ/2) of its length and lies (1 − t) θ/2 behind it; so the
// axis, far away where the turn is small, is never asked for.
Pose Screw::at(double time) const {
  const Vec3 origin =
      origin_ + along_ * time + turned(across_, (time - 1) * angle_ / 2) * share_of_sine(time, angle_ / 2);
  const Quat rotation = rotation_by(axis_ * (angle_ * time)) * start_;
  return {origin - rotation * tool_centre_, rotation};
}

// The arc's tangent at t lies (t − ½) θ behind the chord, and the arc is θ/2 / sin(θ/2) times as long.
Twist Screw::twist(double time) const {
  const double half = angle_ / 2, longer = half < 1e-8 ? 1 : half / std::sin(half);
  return {.axis = axis_,
          .angle = angle_,
          .velocity = (along_ + turned(across_, (time - 0.5) * angle_) * longer) / step_m_,
          .radius = radius_};
}

double Screw::length() const {
  const Twist t = twist(0);
  return glm::length(t.velocity) + t.angle * t.radius;
}

}  // namespace palpate
