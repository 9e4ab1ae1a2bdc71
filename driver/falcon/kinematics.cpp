#include "driver/falcon/kinematics.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace palpate::falcon {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kZeroAngle = 35 * kDegree;
constexpr double kRadiansPerCount = 0.01425 / 0.110 * 360 / 1280 * kDegree;
constexpr double kLeastAngle = -70 * kDegree, kLargestAngle = 135 * kDegree;
constexpr int kNewtonSteps = 24;  // far starts need some ten, the last position of a moving hand 2 or 3
constexpr double kLongestStep =
    0.02;  // m; a longer one would leave the region where the legs' equations are nearly linear

/// cos and sin of the legs' directions: 90°, −30°, −150°, each turned by 15°.
const std::array<std::array<double, 2>, 3> kLegs = [] {
  std::array<std::array<double, 2>, 3> legs{};
  const std::array<double, 3> degrees{105, -15, -135};
  for (std::size_t i = 0; i < 3; ++i)
    legs[i] = {std::cos(degrees[i] * kDegree), std::sin(degrees[i] * kDegree)};
  return legs;
}();

/// One leg at a grip position: the forearm's end seen from the motor's shaft, (u, w), and the length S that
/// the forearm has in that plane, with ∂S/∂v. The leg closes where (u − a·cosθ1)² + (w − a·sinθ1)² = S².
struct Leg {
  double u, w, length, length_by_v;
  bool reachable;
};

Leg leg_at(std::size_t i, const Vec3& p) {
  const double cosine = kLegs[i][0], sine = kLegs[i][1];
  const double u = cosine * p.x + sine * p.y - kBaseRadius;
  const double v = -sine * p.x + cosine * p.y - kBaseShift;
  const double cos3 = (v + kShaftOffset) / kForearm;
  const double sin3_squared = 1 - cos3 * cos3;
  if (!(sin3_squared > 0)) return {0, 0, 0, 0, false};
  const double sin3 = std::sqrt(sin3_squared);
  return {u + kGripOffset, p.z, 2 * kForearmJoints + kForearm * sin3, -cos3 / sin3, true};
}

/// Derivatives of g = (u − a·cosθ)² + (w − a·sinθ)² − S²: halved, by position and by angle.
struct Closure {
  double half_residual;
  Vec3 by_position;
  double by_angle;
};

Closure closure(std::size_t i, const Leg& leg, double angle) {
  const double x = leg.u - kUpperArm * std::cos(angle), z = leg.w - kUpperArm * std::sin(angle);
  const double cosine = kLegs[i][0], sine = kLegs[i][1];
  const double by_v = -leg.length * leg.length_by_v;
  return {(x * x + z * z - leg.length * leg.length) / 2,
          Vec3(cosine * x - sine * by_v, sine * x + cosine * by_v, z),
          kUpperArm * (x * std::sin(angle) - z * std::cos(angle))};
}

using Rows = std::array<Vec3, 3>;

/// Solves rows · x = right by Cramer's rule; nothing where the rows span no volume worth the name: the sine
/// of the solid angle between them under 1e-9, where a step of one count would already move the grip by
/// kilometres.
std::optional<Vec3> solve(const Rows& rows, const Vec3& right) {
  const Vec3 yz = glm::cross(rows[1], rows[2]), zx = glm::cross(rows[2], rows[0]),
             xy = glm::cross(rows[0], rows[1]);
  const double volume = glm::dot(rows[0], yz);
  const double size = glm::length(rows[0]) * glm::length(rows[1]) * glm::length(rows[2]);
  if (!(std::abs(volume) > 1e-9 * size)) return std::nullopt;
  return (right.x * yz + right.y * zx + right.z * xy) / volume;
}

}  // namespace

double angle_of_counts(double counts) { return kZeroAngle + counts * kRadiansPerCount; }

double counts_of_angle(double angle) { return (angle - kZeroAngle) / kRadiansPerCount; }

Angles angles_of_encoders(const Encoders& encoders) {
  return {angle_of_counts(encoders[0]), angle_of_counts(encoders[1]), angle_of_counts(encoders[2])};
}

bool possible(const Angles& angles) {
  return std::all_of(angles.begin(), angles.end(),
                     [](double angle) { return angle >= kLeastAngle && angle <= kLargestAngle; });
}

std::optional<Vec3> position_of_angles(const Angles& angles, const Vec3& guess) {
  Vec3 position = guess;
  double last_step = 1;
  for (int n = 0; n < kNewtonSteps; ++n) {
    Rows rows;
    Vec3 residual;
    for (std::size_t i = 0; i < 3; ++i) {
      const Leg leg = leg_at(i, position);
      if (!leg.reachable) return std::nullopt;
      const Closure at = closure(i, leg, angles[i]);
      rows[i] = at.by_position;
      residual[static_cast<glm::length_t>(i)] = at.half_residual;
    }
    const std::optional<Vec3> step = solve(rows, residual);
    if (!step) return std::nullopt;
    const double size = glm::length(*step);
    position -= size > kLongestStep ? *step * (kLongestStep / size) : *step;
    // Settled: under the last digit that a position of 0.1 m has, or so close to it that rounding alone keeps
    // the step alive.
    if (size < 1e-15 || (size < 1e-13 && size >= last_step / 2)) return position;
    last_step = size;
  }
  return std::nullopt;
}

std::optional<Angles> angles_of_position(const Vec3& position) {
  Angles angles{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Leg leg = leg_at(i, position);
    if (!leg.reachable) return std::nullopt;
    // u·cosθ + w·sinθ = k; with t = tan(θ/2): (k + u)·t² − 2w·t + (k − u) = 0. The smaller t has the elbow
    // outwards.
    const double k =
        (leg.u * leg.u + leg.w * leg.w + kUpperArm * kUpperArm - leg.length * leg.length) / (2 * kUpperArm);
    const double square = leg.u * leg.u + leg.w * leg.w - k * k;
    if (!(square >= 0)) return std::nullopt;
    // θ = 2·atan((w − √…)/(k + u)), written so that neither a small k + u nor a difference of equals costs
    // digits.
    angles[i] = std::atan2(leg.w, leg.u) - std::atan2(std::sqrt(square), k);
    if (!std::isfinite(angles[i])) return std::nullopt;
  }
  return angles;
}

std::optional<std::array<double, 3>> torques_of_force(const Angles& angles, const Vec3& position,
                                                      const Vec3& force) {
  // g(P, θ) = 0 gives ∂P/∂θ_i = −(∂g/∂P)⁻¹ e_i ∂g_i/∂θ_i, so τ_i = F·∂P/∂θ_i = −∂g_i/∂θ_i · x_i with (∂g/∂P)ᵀ
  // x = F.
  Rows rows;
  std::array<double, 3> by_angle{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Leg leg = leg_at(i, position);
    if (!leg.reachable) return std::nullopt;
    const Closure at = closure(i, leg, angles[i]);
    rows[i] = at.by_position;
    by_angle[i] = at.by_angle;
  }
  const Rows columns{Vec3(rows[0].x, rows[1].x, rows[2].x), Vec3(rows[0].y, rows[1].y, rows[2].y),
                     Vec3(rows[0].z, rows[1].z, rows[2].z)};
  const std::optional<Vec3> x = solve(columns, force);
  if (!x) return std::nullopt;
  return std::array<double, 3>{-by_angle[0] * x->x, -by_angle[1] * x->y, -by_angle[2] * x->z};
}

}  // namespace palpate::falcon
