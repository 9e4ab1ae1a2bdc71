#pragma once
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace yardstick {

using Vec3 = glm::dvec3;
using Quat = glm::dquat;

/// World from tool: x ↦ position + rotation · x, metres. Tools are modelled about their centre of volume, so
/// `position` is where that is.
struct Pose {
  Vec3 position{0};
  Quat rotation{1, 0, 0, 0};
};

/// On the tool, world axes; torque about the pose's position. N and N·m.
struct Wrench {
  Vec3 force{0}, torque{0};
};

/// The turn by |by| rad about `by`.
inline Quat turn_by(const Vec3& by) {
  const double angle = glm::length(by);
  return angle > 0 ? glm::angleAxis(angle, by / angle) : Quat(1, 0, 0, 0);
}

/// The turn that leads from one rotation to the other, rad.
inline Vec3 turn_between(const Quat& from, const Quat& to) {
  Quat by = to * glm::conjugate(from);
  if (by.w < 0) by = -by;
  const Vec3 v(by.x, by.y, by.z);
  const double sine = glm::length(v);
  return sine > 0 ? v * (2 * std::atan2(sine, by.w) / sine) : 2.0 * v;
}

/// The tool moved by `way` and turned about its position by `turn`.
inline Pose moved(const Pose& pose, const Vec3& way, const Vec3& turn) {
  return {pose.position + way, glm::normalize(turn_by(turn) * pose.rotation)};
}

}  // namespace yardstick
