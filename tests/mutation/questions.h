#pragma once
#include <string>
#include <vector>

#include "model/collision_backend.h"
#include "model/lattice/pose.h"
#include "service/queries/first_contact.h"

namespace palpate::mutation {

/// The planner's questions (docs/EXACTNESS.md, section 10), as an engine answers them before anything is
/// changed: whether the tool touches, and when it first does on screws that end in given poses. A first
/// contact may come at another time and be right: what is asked is whether it is late, or too early.
class Questions {
 public:
  /// `backend` is prepared for `geometry`. Throws std::runtime_error where it fails.
  Questions(CollisionBackend& backend, const SceneGeometry& geometry, const std::vector<LatticePose>& poses,
            const std::vector<std::uint8_t>& touch);

  /// What the back end says otherwise now; empty: nothing.
  std::string difference(CollisionBackend& backend, const SceneGeometry& geometry) const;

 private:
  struct Motion {
    Pose from, to;
    FirstContact::Kind kind;
    double soonest, latest;  ///< of its contact
  };
  Motion motion_to(CollisionBackend& backend, const SceneGeometry& geometry, const Pose& from,
                   const Pose& to) const;

  TouchRule rule_;
  std::vector<LatticePose> poses_;
  std::vector<std::uint8_t> touch_;
  std::vector<Motion> motions_;
};

}  // namespace palpate::mutation
