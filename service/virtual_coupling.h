#pragma once
#include "service/spring_balance.h"

namespace palpate {

/// A virtual coupling (Colgate, Stanley and Brown 1995), the quasi-static one: the tool has no mass and hangs on the device by a spring. At every tick it is where
/// spring and contact balance, spring · (tool − device) = push(tool), and the device gets that push. In free space they are in one place.
///
/// The planes of the law give way along fixed lines, so push is minus the gradient of a convex energy E, and the tool's place is the one minimum of
/// E(tool) + ½ spring (tool − device)². What the device feels is then the gradient of E's Moreau envelope: the wall and the spring in series. It is
/// continuous, never pulls, and no stiffer than the spring, whatever K and however many areas; so a device of damping b is stable
/// under any wall once the spring is below b / (T/2). The price is a softer wall.
///
/// Found by spring_balance from the tick before on; plain arithmetic on fixed memory: no clock, no allocation.
class VirtualCoupling {
 public:
  static constexpr double kFastest = 0.01, kFastestTurn = 0.1;   ///< m and rad a tick: so the tool leaves no wall with a jump that the law would take for the device's (chosen)

  explicit VirtualCoupling(const CouplingSettings& settings) : settings_(settings) {}

  /// Where the tool is while the device is at `device`. Call it once a tick, before the law's step. `law` is `corrected`.
  LawPose follow(const ForceLawState& law, const LawPose& device);
  /// Tool and device are in one place again.
  void reset() { apart_ = {}; }

 private:
  CouplingSettings settings_;
  Vec6 apart_{};   ///< tool minus device, m and rad
};

}  // namespace palpate
