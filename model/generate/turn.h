#pragma once
#include <cmath>

#include "model/lattice/vector.h"

namespace palpate {

inline constexpr double kPi = 3.14159265358979323846;

/// Cosine and sine of an angle. Unlike the C library's they are sums and products alone, so a generated scene
/// has the same bytes on every machine. Accurate to 2e-16; exact at quarter turns.
struct Turn {
  double cos = 1;
  double sin = 0;
};

/// `turns` whole turns (1 is 360°), any finite number.
inline Turn turn_by(double turns) {
  const double quarters = turns * 4;
  const double nearest = std::floor(quarters + 0.5);
  const double r = (quarters - nearest) * (kPi / 2);  // [−π/4, π/4]
  const double s = -r * r;
  double sine = 1, cosine = 1;
  for (int k = 18; k >= 2; k -= 2) {  // Taylor by Horner; the first term left out is below 1e-19
    sine = 1 + s / (k * (k + 1)) * sine;
    cosine = 1 + s / ((k - 1) * k) * cosine;
  }
  sine *= r;
  const double phase = nearest - 4 * std::floor(nearest / 4);
  if (phase < 0.5) return {cosine, sine};
  if (phase < 1.5) return {-sine, cosine};
  if (phase < 2.5) return {-cosine, -sine};
  return {sine, -cosine};
}

/// `angle` in radians.
inline Turn turn_rad(double angle) { return turn_by(angle / (2 * kPi)); }

/// Rotation by `angle` (radians) about a unit `axis`.
inline Quat rotation_about(const Vec3& axis, double angle) {
  const Turn half = turn_rad(angle / 2);
  return Quat(half.cos, axis.x * half.sin, axis.y * half.sin, axis.z * half.sin);
}

/// Rotation by the vector's length (rad) about its direction.
inline Quat rotation_about(const Vec3& vector) {
  const double angle = std::sqrt(vector.x * vector.x + vector.y * vector.y + vector.z * vector.z);
  return angle > 0 ? rotation_about(vector / angle, angle) : Quat(1, 0, 0, 0);
}

}  // namespace palpate
