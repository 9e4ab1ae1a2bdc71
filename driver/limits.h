#pragma once
#include <cmath>

#include "model/lattice/pose.h"

namespace palpate {

inline bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

inline bool finite(const Wrench& wrench) { return finite(wrench.force) && finite(wrench.torque); }

/// Euclidean length that neither overflows nor turns a finite vector into infinity.
inline double length(const Vec3& v) { return std::hypot(v.x, v.y, v.z); }

/// The vector, shortened to `limit` where it is longer; its direction stays. A limit that is not > 0 leaves
/// nothing.
inline Vec3 shortened(const Vec3& v, double limit) {
  if (!(limit > 0)) return Vec3(0);
  const double size = length(v);
  if (size <= limit) return v;
  return std::isfinite(size) ? v * (limit / size) : Vec3(0);
}

/// Whether a pose is one: finite, and the quaternion's length 1 within kUnitQuaternionTolerance.
inline bool sound(const Pose& pose) {
  const Quat& q = pose.rotation;
  const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  return finite(pose.position) && std::isfinite(square) && std::abs(square - 1) <= kUnitQuaternionTolerance;
}

/// The same wrench with its torque about `to` instead of `from` (both world, m).
inline Wrench moved(const Wrench& wrench, const Vec3& from, const Vec3& to) {
  return {wrench.force, wrench.torque + glm::cross(from - to, wrench.force)};
}

}  // namespace palpate
