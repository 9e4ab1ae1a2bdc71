#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "model/collision_backend.h"
#include "model/contact/response.h"
#include "service/loop/plane_set.h"
#include "service/loop/spring_balance.h"

namespace palpate {

/// Anderson's method on z = T(z): the next z from the last few z and T(z). Turns count by their way at the
/// tool's radius of gyration, so that a length is a length.
class Anderson {
 public:
  /// The tool's radius of gyration, m.
  explicit Anderson(double gyration) : gyration_(gyration) {}
  /// Of two ways (m, rad), m².
  double product(const Vec6& a, const Vec6& b) const;
  /// Of a way, m.
  double length(const Vec6& v) const;

  /// `image`: T(z).
  Vec6 next(const Vec6& z, const Vec6& image);
  /// What was before says nothing of what comes.
  void forget() { count_ = 0; }

 private:
  static constexpr std::size_t kMemory = 5;
  double gyration_;
  std::size_t count_ = 0;
  std::array<Vec6, kMemory> rest_steps_{}, image_steps_{};
  Vec6 last_rest_{}, last_image_{};
};

/// `refined`: force and torque of a lone pose. The tool hangs on the device by a spring of stiffness K and
/// Kρ² (ρ: its radius of gyration), and is where spring and field balance: F = −∇ min_y [E(y) + ½ |x − y|²],
/// the gradient of the field's Moreau envelope. It is conservative as the field is, and no contact, however
/// large, is stiffer than the spring. In a session the control law does the same tick by tick
/// (service/loop/virtual_coupling.h).
///
/// The field's planes at a pose give the next one, as in the law; Anderson's method makes up for what planes
/// leave out. From the pose asked for on, in steps no longer than the contact is deep, so of several balances
/// it finds the one that a hand at rest there would. One thread; allocates only as its answers grow.
class LoneQuery {
 public:
  static constexpr int kMostEvaluations =
      60;  ///< from 2 for a flat contact to 34 (p99) along a piston's pull (measured; the rest is room)

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

  /// The same step by step, for whoever asks for many at once: begin(), then as long as wanted() has a pose,
  /// what respond() says there to take(). At last felt() puts what would be felt into `response`.
  void begin(const Pose& pose, const ContactResponse& at_pose, bool from_before = false);
  /// Where the field is wanted next; none: the balance is found, or not to be found.
  std::optional<Pose> wanted() const;
  /// What respond() says at wanted().
  void take(const ContactResponse& there);
  /// As feel() leaves `response`.
  void felt(ContactResponse& response) const;

  /// The spring whose balance is sought.
  CouplingSettings spring() const { return spring_; }

 private:
  enum class Stage : std::uint8_t { kFromBefore, kStep, kDone };

  Vec6 pull(const Wrench& push, const Vec6& apart) const;
  Vec6 next(const Vec6& apart) const;
  bool settled() const;
  bool found() const;
  double farthest(const ContactResponse& at) const;
  void begin_step();
  void want(const Vec6& apart, Stage stage);
  void finish();

  const SceneGeometry& geometry_;
  double stiffness_;
  CouplingSettings spring_;
  Contacts contacts_;
  ContactResponse response_;
  std::optional<Vec6> before_;  ///< the balance of the last pose asked, if that was in contact

  // Of the pose that is asked for now.
  Stage stage_ = Stage::kDone;
  Felt felt_;
  LawPose device_, tool_;  ///< tool_: where the field is wanted
  Vec6 there_{};           ///< likewise, apart from device_
  PlaneSet planes_;        ///< of the field where it was last evaluated
  double enough_ = 0, enough_share_ = 0;
  Anderson anderson_;
  Vec6 apart_{}, rest_{}, image_{}, best_{};
  double left_ = 0, least_ = 0;
  double farthest_ = 0;  ///< that a step from apart_ may lead, m
  double halved_ = 0;    ///< least_ when it last was half of what it had been
  int idle_ = 0;         ///< evaluations since
  // Of its present step.
  Vec6 way_{}, step_{};
  double slope_here_ = 0, low_ = 0, low_slope_ = 0, high_ = 0, high_slope_ = 0, share_ = 1;
  int tried_ = 0;
};

/// Balances of many poses, in rounds: where the fields of all that are under way are wanted is asked
/// together. The same answers as LoneQuery::feel of each. One thread.
class LoneQueries {
 public:
  /// As LoneQuery's.
  LoneQueries(const SceneGeometry& geometry, double stiffness) : geometry_(geometry), stiffness_(stiffness) {}

  /// As LoneQuery::feel, of each pose; as many responses as poses. Error: the back end failed.
  Result<void> feel(PoseQuery& backend, std::span<const Pose> poses,
                    std::span<ContactResponse* const> responses);

 private:
  const SceneGeometry& geometry_;
  double stiffness_;
  std::vector<LoneQuery> under_way_;
  std::vector<Contacts> contacts_;
  ContactResponse response_;
};

}  // namespace palpate
