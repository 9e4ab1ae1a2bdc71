#include "bench/haptic/penalty.h"

#include <array>
#include <cmath>
#include <utility>

namespace yardstick {
namespace {

/// Way and turn · ρ, or force and torque / ρ: of one unit, so that steps and residuals have a length.
using Six = std::array<double, 6>;
using SixBySix = std::array<Six, 6>;

double length(const Six& a) {
  double sum = 0;
  for (const double v : a) sum += v * v;
  return std::sqrt(sum);
}

/// Gauss with pivots; `a` is positive definite.
Six solve(SixBySix a, Six b) {
  for (std::size_t i = 0; i < 6; ++i) {
    std::size_t pivot = i;
    for (std::size_t r = i + 1; r < 6; ++r)
      if (std::abs(a[r][i]) > std::abs(a[pivot][i])) pivot = r;
    std::swap(a[i], a[pivot]);
    std::swap(b[i], b[pivot]);
    for (std::size_t r = i + 1; r < 6; ++r) {
      const double by = a[r][i] / a[i][i];
      for (std::size_t c = i; c < 6; ++c) a[r][c] -= by * a[i][c];
      b[r] -= by * b[i];
    }
  }
  Six x{};
  for (std::size_t i = 6; i-- > 0;) {
    double sum = b[i];
    for (std::size_t c = i + 1; c < 6; ++c) sum -= a[i][c] * x[c];
    x[i] = sum / a[i][i];
  }
  return x;
}

}  // namespace

void PenaltyAdapter::prepare(const Case& subject) {
  stiffness_ = subject.stiffness;
  gyration_ = subject.gyration;
  build(subject);
}

Answer PenaltyAdapter::answer(const Pose& hand) {
  const double k = stiffness_, rho = gyration_;
  Answer out;
  Six at{};    // where the tool is, from the hand
  Six from{};  // where the last step began
  Six step{};
  double last = INFINITY, part = 1;
  Six best{};
  double best_residual = INFINITY;
  for (out.evaluations = 1;; ++out.evaluations) {
    const Pose tool = moved(hand, Vec3(at[0], at[1], at[2]), Vec3(at[3], at[4], at[5]) / rho);
    find(tool, springs_);
    if (out.evaluations == 1 && springs_.empty()) return out;
    Six residual{};
    SixBySix stiff{};
    for (std::size_t i = 0; i < 6; ++i) {
      residual[i] = -k * at[i];
      stiff[i][i] = k;
    }
    const double each = spring_stiffness(k, springs_.size());
    for (const ContactSpring& spring : springs_) {
      const Vec3 turning = glm::cross(spring.point - tool.position, spring.normal) / rho;
      const Six line{spring.normal.x, spring.normal.y, spring.normal.z, turning.x, turning.y, turning.z};
      for (std::size_t i = 0; i < 6; ++i) {
        residual[i] += each * spring.depth * line[i];
        for (std::size_t j = 0; j < 6; ++j) stiff[i][j] += each * line[i] * line[j];
      }
    }
    const double size = length(residual);
    if (size < best_residual) {
      best_residual = size;
      best = at;
    }
    // Settled where the hand could not feel the rest: K times a tenth of a micrometre.
    if (size <= k * 1e-7) break;
    if (out.evaluations == kMostEvaluations) {
      out.settled = false;
      break;
    }
    if (size > last && part > 0.02) {  // it was worse there: half the way, from where it began
      part /= 2;
    } else {
      from = at;
      step = solve(stiff, residual);
      last = size;
      part = 1;
    }
    for (std::size_t i = 0; i < 6; ++i) at[i] = from[i] + part * step[i];
  }
  out.wrench.force = k * Vec3(best[0], best[1], best[2]);
  out.wrench.torque = k * rho * Vec3(best[3], best[4], best[5]);
  return out;
}

}  // namespace yardstick
