#pragma once
#include <optional>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "service/loop/plane_set.h"
#include "service/loop/spring_balance.h"

namespace palpate {

/// `refined`: force and torque of a lone pose. The tool hangs on the device by a spring of stiffness K and
/// Kρ² (ρ: its radius of gyration), and is where spring and field balance: F = −∇ min_y [E(y) + ½ |x − y|²],
/// the gradient of the field's Moreau envelope. It is conservative as the field is, and no contact, however
/// large, is stiffer than the spring. In a session the control law does the same tick by tick
/// (service/loop/virtual_coupling.h).
///
/// The field's planes at a pose give the next one, as in the law; Anderson's method makes up for what planes
/// leave out. From the pose asked for on, so of several balances it finds the one that a hand at rest there
/// would. One thread; allocates only as its answers grow.
class LoneQuery {
 public:
  static constexpr int kMostEvaluations = 60;  ///< from 2 for a flat contact to 20 for a pose far deeper than
                                               ///< a hand gets (measured; the rest is room)

  /// `geometry` outlives this. `stiffness` K in N/m.
  LoneQuery(const SceneGeometry& geometry, double stiffness);

  /// Puts what would be felt into `response`, which is what respond() said at `pose`: `felt`, and the flag
  /// `unsettled`. `from_before`: for a hand that moves and looks on: the balance is looked for from the one
  /// before on, and to a thousandth, which takes a third as many evaluations. Error: the back end failed.
  Result<void> feel(PoseQuery& backend, const Ignored* ignored, const Pose& pose, ContactResponse& response,
                    bool from_before = false);

  /// `at_pose`: what respond() says at `pose`. Without contact there, or with K = 0, there is nothing to ask.
  /// `ignored` as for CollisionBackend::query. Error: the back end failed.
  Result<Felt> ask(PoseQuery& backend, const Ignored* ignored, const Pose& pose,
                   const ContactResponse& at_pose, bool from_before = false);

  /// The spring whose balance is sought.
  CouplingSettings spring() const { return spring_; }

 private:
  Result<void> evaluate(PoseQuery& backend, const Ignored* ignored, const LawPose& tool);
  Vec6 pull(const Wrench& push, const Vec6& apart) const;
  Vec6 next(const LawPose& device, const Vec6& apart) const;

  const SceneGeometry& geometry_;
  double stiffness_;
  CouplingSettings spring_;
  Contacts contacts_;
  ContactResponse response_;
  PlaneSet planes_;
  std::optional<Vec6> before_;  ///< the balance of the last pose asked, if that was in contact
};

}  // namespace palpate
