#pragma once
#include <array>
#include <cstdint>

#include "model/lattice/pose.h"

namespace palpate {

/// How a device that is pushed, not moved, steers the tool.
struct RateSettings {
  double dead_zone = 0.08;      ///< of full deflection, an axis: less is a hand at rest
  double speed_m_per_s = 0.1;   ///< at full deflection
  double turn_rad_per_s = 1.0;  ///< at full deflection
};

/// Moves a pose with a velocity that grows with the square of the deflection beyond the dead zone: fine near
/// rest, fast at the end. The six deflections are in the world's axes, −1…1 (more is cut), the tool turning
/// about its own origin. One step is one tick of 1 ms; pure, nothing allocated, the quaternion kept a unit
/// one. Deflections that aren't numbers count as rest.
class RateControl {
 public:
  RateControl(const RateSettings& settings, const Pose& start) noexcept : settings_(settings), pose_(start) {}
  const Pose& step(const std::array<double, 6>& deflection) noexcept;
  const Pose& pose() const noexcept { return pose_; }

 private:
  double shaped(double deflection) const noexcept;
  RateSettings settings_;
  Pose pose_;
};

}  // namespace palpate
