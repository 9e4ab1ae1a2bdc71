#include "service/bench/error/error_control.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace palpate {
namespace {

constexpr double kRadius = 20e-3, kDeepest = 3e-3, kStiffness = 2000;  // m, m, N/m
constexpr int kTicks = 1200;                                           // two presses of 0.6 s

/// How deep the ball's lowest point is at a tick; below 0: above the plane.
double depth_at(int tick) {
  return kDeepest * (0.55 - 0.75 * std::cos(2 * 3.14159265358979 * 2 * tick / kTicks));
}

double mean_depth(double h) { return h > 0 ? h * (3 * kRadius - h) / (3 * (2 * kRadius - h)) : 0; }
/// ∂d/∂h of the above.
double slope(double h) {
  const double e = 1e-9;
  return (mean_depth(h + e) - mean_depth(std::max(h - e, 0.0))) / (h > e ? 2 * e : e + h);
}

LawResult result_at(int tick) {
  LawResult out;
  const double h = depth_at(tick);
  out.tick = tick;
  out.gc = Vec3(0, 0, kRadius - h);
  if (h <= 0) return out;
  out.contact = true;
  out.areas = 1;
  out.plane_count = 1;
  out.planes[0] = {Vec3(0, 0, 1), Vec3(0), kStiffness * mean_depth(h),
                   std::min(kStiffness, std::max(kStiffness / 4, kStiffness * slope(h)))};
  out.wrench.force = Vec3(0, 0, kStiffness * mean_depth(h));
  return out;
}

}  // namespace

ControlError control_error(LawKind kind, int age, int transitions) {
  ControlError out{kind, age, transitions, {}, 0};
  ForceLawState law({.kind = kind, .stiffness_n_per_m = kStiffness, .transitions = transitions});
  double spent = 0;
  for (int i = 0; i < kTicks; ++i) {
    LawResult result;
    const bool fresh = i >= age && i % age == 0;
    if (fresh) result = result_at(i - age);
    const auto start = std::chrono::steady_clock::now();
    const Wrench felt =
        law.step({i, Vec3(0, 0, kRadius - depth_at(i)), Quat(1, 0, 0, 0)}, fresh ? &result : nullptr);
    spent += std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
    out.errors_n.push_back(std::fabs(felt.force.z - kStiffness * mean_depth(depth_at(i))));
  }
  out.step_us = spent / kTicks;
  return out;
}

}  // namespace palpate
