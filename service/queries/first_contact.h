#pragma once
#include <cstdint>

#include "model/collision_backend.h"
#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate {

/// What counts as contact for the planner's questions (docs/EXACTNESS.md, section 10).
struct TouchRule {
  std::int32_t tolerance = 0;  ///< steps; > 0: contact no deeper does not count. The back end then has been
                               ///< prepared with `contact_samples` = 0
  std::int32_t early = 16;     ///< whole steps by which a first contact may be early: less than one more

  /// A tolerance in metres, rounded down, and the larger of 1 µm and 16 steps.
  static TouchRule of(const SceneGeometry& geometry, double tolerance_m);
};

/// When a tool on a screw first touches.
struct FirstContact {
  /// What was found.
  enum class Kind : std::uint8_t {
    kNone,  ///< it stays clear all the way
    kContact,
    kUndecided,  ///< it goes along so near that kMostSteps evaluations did not bring it to an end: clear
                 ///< until `time`, perhaps further
  };
  Kind kind = Kind::kNone;
  double time = 1;         ///< from 0 to 1: clear until then for certain
  std::int32_t steps = 0;  ///< how far the two are apart there
  std::uint32_t static_id = kNoTriangle,
                mobile_id =
                    kNoTriangle;  ///< that come together; kNoTriangle: what touches is the sets' to say
  std::uint64_t evaluations = 0;  ///< poses that were asked about
};

inline constexpr std::uint64_t kMostSteps = 100'000;  ///< evaluations on one screw (chosen: half a minute)

/// Never late, early by at most `rule.early` whole steps. Errors: a pose that is none (kBadValue), the back
/// end's.
Result<FirstContact> first_contact(CollisionBackend& backend, const SceneGeometry& geometry, const Pose& from,
                                   const Pose& to, const TouchRule& rule);

/// Whether a pose touches under the rule, and how deep it is then, steps; without tolerance −1 for the depth.
struct Touch {
  bool touches = false;
  std::int64_t depth = -1;
  std::uint32_t static_id = kNoTriangle,
                mobile_id = kNoTriangle;  ///< of the deepest sample; kNoTriangle: none lies in the other body
};
/// Whether the tool touches at a pose, and how deep, by a rule.
Result<Touch> touch_at(CollisionBackend& backend, const LatticePose& pose, const TouchRule& rule);

}  // namespace palpate
