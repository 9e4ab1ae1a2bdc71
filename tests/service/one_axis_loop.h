#pragma once
#include <algorithm>
#include <cmath>

#include "driver/mass_spring.h"
#include "service/force_law.h"

namespace palpate {

/// METHOD's yardstick: a mass with a damper against a flat wall of stiffness `contact_k`, one axis (x, the wall's normal), tick
/// 1 ms. A result for the pose of tick i arrives at i + delay, and then the next one is started. The mass is
/// pressed into the wall by a constant force, deep enough that no clamp is met: the loop is linear.
struct OneAxisLoop {
  double mass = 0.5, damping = 1;   ///< kg, N·s/m
  double contact_k = 2000;          ///< N/m, of the wall
  double kappa_ratio = 1;           ///< κ of the plane = kappa_ratio · contact_k
  int delay = 1;                    ///< c, ticks
  ForceLawSettings law;

  /// Whether a small push dies out: its largest excursion in the last quarter against the one in the second.
  bool stable(int ticks) {
    law.stiffness_n_per_m = contact_k;
    ForceLawState state(law);
    const MassSpring motion(mass, damping, 0, 1e-3);
    constexpr double kRestDepth = 1.0;   // m: K·1 m of preload against micrometres of motion
    const double preload = -contact_k * kRestDepth;
    double x = 1e-6, velocity = 0, early = 0, late = 0;   // x: m out of the wall, from the rest position
    LawResult pending;
    for (int i = 0; i < ticks; ++i) {
      LawResult arrived;
      if (i % delay == 0) {
        arrived = pending;
        pending = result_at(i, x, kRestDepth);
      }
      const LawPose pose{.tick = i, .gc = Vec3(x, 0, 0)};
      double force = state.step(pose, arrived.tick >= 0 ? &arrived : nullptr).force.x;
      // Until the first results are blended in, the wall is there at once: the loop starts at its rest.
      if (i < kSettle) force = contact_k * (kRestDepth - x);
      motion.step(x, velocity, force + preload);
      if (!(std::abs(x) < 0.1)) return false;
      if (i > ticks / 4 && i <= ticks / 2) early = std::max(early, std::abs(x));
      if (i > ticks - ticks / 4) late = std::max(late, std::abs(x));
    }
    // Neither growing nor lasting; below 10 pm the preload's rounding is all that is left.
    return late < 0.95 * early || late < 1e-11;
  }

  /// Highest stable stiffness of the wall in N/m, to 0.2 %; 0 if even 20 N/m is not.
  double critical_stiffness(int ticks = 20000) {
    double low = 20, high = 8000;
    const auto stable_at = [&](double k) {
      contact_k = k;
      return stable(ticks);
    };
    if (!stable_at(low)) return 0;
    while (high - low > 0.002 * low) {
      const double middle = 0.5 * (low + high);
      (stable_at(middle) ? low : high) = middle;
    }
    return low;
  }

 private:
  static constexpr int kSettle = 200;

  LawResult result_at(int tick, double x, double rest_depth) const {
    LawResult result;
    result.tick = tick;
    result.gc = Vec3(x, 0, 0);
    result.contact = true;
    const double force = contact_k * (rest_depth - x);
    result.wrench.force = Vec3(force, 0, 0);
    result.plane_count = result.areas = 1;
    result.planes[0] = {.normal = Vec3(1, 0, 0), .force = force, .stiffness = kappa_ratio * contact_k};
    return result;
  }
};

}  // namespace palpate
