#include "driver/passivity.h"

#include <algorithm>

#include "driver/haptic_device.h"
#include "model/lattice/rotation.h"

namespace palpate {

void Passivity::observe(const Wrench& sent, const Vec3& gc, const Quat& rotation) noexcept {
  moved_ = started_ ? gc - gc_ : Vec3(0);
  turned_ = started_ ? rotation_vector(rotation * glm::conjugate(rotation_)) : Vec3(0);
  gc_ = gc;
  rotation_ = rotation;
  started_ = true;
  work_ += glm::dot(sent.force, moved_) + glm::dot(sent.torque, turned_);
  idle_ticks_ = sent.force == Vec3(0) && sent.torque == Vec3(0) ? idle_ticks_ + 1 : 0;
  if (idle_ticks_ >= 100) work_ = 0;
}

Wrench Passivity::damping() const noexcept {
  if (!(work_ > 0)) return {};
  // Were the next tick's motion like this one's, a damping of `all` would take all of it back at once.
  const double way = glm::dot(moved_, moved_) + kArm * kArm * glm::dot(turned_, turned_);
  if (!(way > 0)) return {};
  const double all = work_ * kTickSeconds / way;
  const double damping = std::min(all, kMostDamping) / kTickSeconds;  // N per metre of a tick's way
  return {-damping * moved_, -damping * kArm * kArm * turned_};
}

}  // namespace palpate
