#pragma once
#include "model/lattice/pose.h"

namespace palpate {

/// Time-domain passivity (Hannaford and Ryu 2002) for a force held from tick to tick. The observer counts the
/// work that the device has done on the hand: Σ F·Δx + T·Δθ, exact for a held force whatever the hand did in
/// between. A passive wall gives back at most what it was given, so the count stays ≤ 0; what is above 0 the
/// wall has made itself, and the controller takes it back with damping, at most `kMostDamping`. Where nothing
/// has pushed for 100 ticks the count starts anew: energy lost in one contact is no allowance for the next.
/// Never allocates.
class Passivity {
 public:
  /// At most so much damping, N·s/m: with a device of 0.1 kg, a tick takes away less than a tenth of its
  /// speed (chosen).
  static constexpr double kMostDamping = 10;
  /// Rotation counts as motion at this distance from gc, m (chosen).
  static constexpr double kArm = 0.1;

  /// Counts what `sent`, the wrench of the tick before, has done on the way to this pose.
  void observe(const Wrench& sent, const Vec3& gc, const Quat& rotation) noexcept;
  /// The damping wrench to add in this tick; zero while the count is ≤ 0.
  Wrench damping() const noexcept;
  /// Begins the count anew.
  void reset() noexcept { *this = {}; }
  double work() const noexcept { return work_; }  ///< J, done on the hand since the count began

 private:
  double work_ = 0;
  Vec3 moved_{0}, turned_{0};  ///< in the last tick, m and rad
  Vec3 gc_{0};
  Quat rotation_{1, 0, 0, 0};
  int idle_ticks_ = 0;
  bool started_ = false;
};

}  // namespace palpate
