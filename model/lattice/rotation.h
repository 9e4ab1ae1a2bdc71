#pragma once
#include <cmath>

#include "model/lattice/vector.h"

namespace palpate {

/// Axis times angle (rad, at most π: the short way) of a unit quaternion.
inline Vec3 rotation_vector(const Quat& rotation) {
  const double sign = rotation.w < 0 ? -1.0 : 1.0;
  const Vec3 v = sign * Vec3(rotation.x, rotation.y, rotation.z);
  const double sine = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  if (sine < 1e-12) return 2.0 * v;  // 2·atan2(s, w)/s → 2
  return (2.0 * std::atan2(sine, sign * rotation.w) / sine) * v;
}

/// Unit quaternion that turns by |vector| rad about vector. Exactly the identity for 0.
inline Quat rotation_by(const Vec3& vector) {
  const double angle = std::sqrt(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z);
  const double scale = angle < 1e-12 ? 0.5 : std::sin(0.5 * angle) / angle;
  return Quat(std::cos(0.5 * angle), scale * vector.x, scale * vector.y, scale * vector.z);
}

}  // namespace palpate
