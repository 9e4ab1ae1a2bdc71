#pragma once
#include "model/scene/scene.h"
#include "service/loop/spring_balance.h"

namespace palpate {

/// The springs of a session: the profile may change in mid-run.
struct Couplings {
  CouplingSettings field;  ///< profile `refined`
  CouplingSettings areas;  ///< profile `paper`
};

/// What the scene says. "auto" is K and Kρ² for profile `refined`, ρ the tool's radius of gyration: the
/// field's walls may be far stiffer than K, and K is what a hand is to feel. For `paper`, whose areas have K
/// each, it is none.
Couplings couplings_of(const Scene& scene, double tool_gyration_m);

/// A virtual coupling (Colgate, Stanley and Brown 1995), the quasi-static one: the tool has no mass and hangs
/// on the device by a spring. At every tick it is where spring and contact balance, spring · (tool − device)
/// = push(tool), and the device gets that push. In free space they are in one place.
///
/// The planes of the law give way along fixed lines, so push is minus the gradient of a convex energy E, and
/// the tool's place is the one minimum of E(tool) + ½ spring (tool − device)². What the device feels is then
/// the gradient of E's Moreau envelope: the wall and the spring in series. It is continuous, never pulls, and
/// no stiffer than the spring, whatever K and however many areas; so a device of damping b is stable under
/// any wall once the spring is below b / (T/2). The price is a softer wall.
///
/// As the device moves, the balance moves no further than it, spring for spring. What moves it more is a
/// change of what is known: a new result. So in a tick the tool goes no further from where it hung than 3
/// times the device's way, plus what `change_n_per_s` allows: the force never jumps, whatever results come.
///
/// Found by spring_balance from the tick before on; plain arithmetic on fixed memory: no clock, no
/// allocation.
class VirtualCoupling {
 public:
  static constexpr double kFastest = 0.01,
                          kFastestTurn = 0.1;  ///< m and rad a tick: so the tool leaves no wall with a jump
                                               ///< that the law would take for the device's (chosen)
  static constexpr double kLongestLever =
      0.1;  ///< m: how far a turn that no spring gives moves a contact (chosen)

  /// `change_n_per_s`: 0: no limit.
  explicit VirtualCoupling(const CouplingSettings& settings, double change_n_per_s = 0)
      : settings_(settings), change_n_per_s_(change_n_per_s) {}

  /// Where the tool is while the device is at `device`. Call it once a tick, before the law's step. `law` is
  /// `corrected`.
  LawPose follow(const ForceLawState& law, const LawPose& device);
  /// What the spring pulls the device with; where there is none, `pushed` as it is.
  Wrench force(const Wrench& pushed) const;
  bool on() const { return settings_.on(); }
  /// Nothing reaches the device but by a spring.
  bool all() const { return settings_.stiffness_n_per_m > 0 && settings_.stiffness_nm_per_rad > 0; }
  /// Tool and device are in one place again.
  void reset() { apart_ = {}; }

 private:
  double size(const Vec6& v) const;
  double allowed(const LawPose& device);

  CouplingSettings settings_;
  double change_n_per_s_;
  Vec6 apart_{};  ///< tool minus device, m and rad
  LawPose last_;  ///< of the device, at the tick before
  bool followed_ = false;
};

}  // namespace palpate
