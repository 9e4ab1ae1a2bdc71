#pragma once
#include <optional>
#include <vector>

#include "bench/haptic/adapter.h"

namespace yardstick {

/// What a hand at a pose was told, and what it took.
struct Sample {
  Pose hand;
  Answer answer;
  double wall_us = 0, cpu_us = 0;  ///< cpu: of all threads of the process
};

/// What was measured of a method on a case.
struct Measured {
  std::vector<Sample> path, loop, rest;
  double tremble_m = 0;  ///< rms along each axis of the hand's places in `rest`
  double prepare_s = 0, memory_mib = 0;
  bool cpu_clock = false;  ///< which of a sample's times counts
};

/// Errors are of the poses of the path whose `Truth::scale` is a tenth of the path's largest or more.
struct Figures {
  std::optional<double> direction_p50_deg, direction_p95_deg;  ///< between F and F*, or its way; no F: 90
  std::optional<double> magnitude_p50, magnitude_p95;          ///< ||F| − |F*|| / scale
  std::optional<double> torque_p50, torque_p95;                ///< |T − T*| / (ρ · scale)
  double step = 0;  ///< largest |ΔF| / (K |Δx|) on the path; |Δx|: way + farthest point · turn. A spring: 1
  double noise = 0;  ///< rms of F about its mean, over K and the tremble's rms in three axes. A spring: ≤ 1
  double loop_lost = 0;  ///< |∮ dW| / ∮ |dW|, dW = F · dx + T · dθ by the trapezoid rule
  double frame_p50_us = 0, frame_p99_us = 0;  ///< of whole answers
  double evaluation_p50_us = 0;               ///< an answer's time over its evaluations
  double unsettled = 0;                       ///< share of the path's poses
};

Figures figures_of(const Case& subject, const Measured& measured);

/// The value that a share q of the others lies below; between two by straight line.
double quantile(std::vector<double> values, double q);

}  // namespace yardstick
