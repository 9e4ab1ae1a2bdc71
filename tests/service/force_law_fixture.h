#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "service/loop/axis_loop.h"
#include "service/loop/force_law.h"

// What the tests of the force law share.
namespace palpate {

inline constexpr double kK = 2000;    // N/m
inline constexpr double kRate = 100;  // N/s
inline constexpr LawKind kH = LawKind::kHold, kP = LawKind::kPrinted, kC = LawKind::kCorrected;

/// A wall at x = 0 whose outside is +x, met by a point tool at gc = (x, 0, 0).
inline LawResult wall(std::int64_t tick, double x, double kappa = kK) {
  LawResult result;
  result.tick = tick;
  result.gc = Vec3(x, 0, 0);
  if (x < 0) {
    result.contact = true;
    result.wrench.force.x = -kK * x;
    result.plane_count = result.areas = 1;
    result.planes[0] = {.normal = Vec3(1, 0, 0), .force = -kK * x, .stiffness = kappa};
  }
  return result;
}

inline LawPose at(std::int64_t tick, double x) { return {.tick = tick, .gc = Vec3(x, 0, 0)}; }

inline ForceLawSettings law(LawKind kind, int transitions, bool stops = false) {
  return {.kind = kind, .stiffness_n_per_m = kK, .transitions = transitions, .printed_stops_at_n = stops};
}

inline ForceLawSettings steady(int transitions) {
  ForceLawSettings settings = law(LawKind::kCorrected, transitions);
  settings.change_n_per_s = kRate;
  return settings;
}

// The highest stable stiffness of the design's table; measured there by pole analysis, here by bisection of
// runs.

/// The design's yardstick: 0.5 kg, 1 N·s/m, pressed so deep into a linear wall that nothing is clamped.
inline AxisLoop pressed(const ForceLawSettings& settings, int delay, double stiffness, double ratio = 1,
                        double depth = 1) {
  AxisLoop loop;
  loop.law = settings;
  loop.law.stiffness_n_per_m = stiffness;
  loop.delivery.delay = delay;
  loop.contact = linear_wall(stiffness, depth, 1, ratio, false);
  loop.load_n = -stiffness * depth;
  return loop;
}

// 20 pm: at 2000 N the rounding of the force alone moves the mass by less.
inline bool stable(const AxisLoop& loop, int ticks = 20000) {
  return AxisLoop::stable(loop.run(ticks), 2e-11);
}

inline double critical_stiffness(const ForceLawSettings& settings, int delay, double ratio = 1,
                                 double depth = 1) {
  return highest_stable(20, 8000,
                        [&](double k) { return stable(pressed(settings, delay, k, ratio, depth)); });
}

}  // namespace palpate
