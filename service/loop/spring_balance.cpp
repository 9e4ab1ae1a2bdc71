#include "service/loop/spring_balance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

/// Solves a·x = b for a symmetric positive definite a, by Cholesky's method. False: it isn't one.
bool solve(StiffnessMatrix a, Vec6& x) {
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    if (!(a[j][j] > 0)) return false;
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < 6; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (std::size_t i = 6; i-- > 0;) {
    for (std::size_t k = i + 1; k < 6; ++k) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return true;
}

/// What is out of balance with the tool `apart` from the device, and how that gives way; an axis without a
/// spring is rigid and takes no part.
void balance(const CouplingSettings& settings, const Feel& feel, const LawPose& device, const Vec6& apart,
             Vec6& rest, StiffnessMatrix& slope) {
  Wrench push;
  feel(apart_from(device, apart, settings), push, slope);
  rest = {push.force.x, push.force.y, push.force.z, push.torque.x, push.torque.y, push.torque.z};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double spring = axis < 3 ? settings.stiffness_n_per_m : settings.stiffness_nm_per_rad;
    if (spring > 0) {
      rest[axis] -= spring * apart[axis];
      slope[axis][axis] += spring;
    } else {
      rest[axis] = 0;
      for (std::size_t other = 0; other < 6; ++other) slope[axis][other] = slope[other][axis] = 0;
      slope[axis][axis] = 1;
    }
  }
}

}  // namespace

LawPose apart_from(const LawPose& device, const Vec6& apart, const CouplingSettings& spring) {
  LawPose pose = device;
  pose.gc += Vec3(apart[0], apart[1], apart[2]);
  if (spring.stiffness_nm_per_rad > 0)
    pose.rotation = glm::normalize(rotation_by(Vec3(apart[3], apart[4], apart[5])) * device.rotation);
  return pose;
}

Vec6 spring_balance(const CouplingSettings& spring, const LawPose& device, Vec6 apart, const Feel& feel) {
  const auto product = [](const Vec6& a, const Vec6& b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 6; ++axis) sum += a[axis] * b[axis];
    return sum;
  };
  Vec6 rest, next{};
  StiffnessMatrix slope;
  balance(spring, feel, device, apart, rest, slope);
  for (int evaluations = 1; evaluations < kMostBalanceEvaluations;) {
    Vec6 step = rest;
    if (!solve(slope, step)) break;
    const double descent = product(step, rest);  // twice the energy that the step hopes for, J
    if (!(descent > kEnoughBalanceJ)) break;
    // Along the step what is left of the rest falls steadily, from `descent` through 0 at the lowest energy.
    // Where it is below 0 at the step's end, some plane began to push on the way: then as far as it is above
    // 0, and near it.
    const auto left_at = [&](double share) {
      for (std::size_t axis = 0; axis < 6; ++axis) next[axis] = apart[axis] + share * step[axis];
      balance(spring, feel, device, next, rest, slope);
      ++evaluations;
      return product(step, rest);
    };
    double low = 0, low_left = descent, high = 1, high_left = left_at(1);
    if (high_left < -0.01 * descent) {  // a hundredth: more than rounding, too little to climb again
      while (evaluations < kMostBalanceEvaluations && !(low > 0 && low_left < 0.3 * descent)) {
        const double middle = low + (high - low) * std::clamp(low_left / (low_left - high_left), 0.1, 0.9),
                     left = left_at(middle);
        (left >= 0 ? low : high) = middle;
        (left >= 0 ? low_left : high_left) = left;
      }
      left_at(low);
    }
    apart = next;
  }
  return apart;
}

}  // namespace palpate
