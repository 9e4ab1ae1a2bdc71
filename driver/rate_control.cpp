#include "driver/rate_control.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "driver/haptic_device.h"

namespace palpate {

double RateControl::shaped(double deflection) const noexcept {
  const double size = std::min(std::abs(deflection), 1.0);
  if (!(size > settings_.dead_zone)) return 0;  // also what isn't a number
  const double beyond = (size - settings_.dead_zone) / (1 - settings_.dead_zone);
  return std::copysign(beyond * beyond, deflection);
}

const Pose& RateControl::step(const std::array<double, 6>& deflection) noexcept {
  const Vec3 velocity(shaped(deflection[0]), shaped(deflection[1]), shaped(deflection[2]));
  const Vec3 turning(shaped(deflection[3]), shaped(deflection[4]), shaped(deflection[5]));
  pose_.position += velocity * (settings_.speed_m_per_s * kTickSeconds);
  // The rotation of half the tick's angle by its tangent, normalised: of the right axis, and short of the
  // angle by a third of its cube over four, 1e-10 rad at most.
  const Vec3 half = turning * (settings_.turn_rad_per_s * kTickSeconds / 2);
  pose_.rotation = glm::normalize(Quat(1, half.x, half.y, half.z) * pose_.rotation);
  return pose_;
}

}  // namespace palpate
