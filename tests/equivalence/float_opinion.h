#pragma once
#include <cstdint>

#include "model/contact/contacts.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate::equivalence {

/// What a program that judges triangles in single precision would have made of the same pairs.
struct FloatOpinion {
  std::uint64_t pairs = 0;  ///< (static, mobile) whose boxes meet, both of them in a set of the frame
  std::uint64_t ambiguous =
      0;  ///< of these: some side of a corner to the other's plane is smaller than its own rounding error
  std::uint64_t wrong = 0;  ///< of these: intersect is answered differently than it is
  std::uint64_t ambiguous_poses = 0, wrong_poses = 0;
};

/// Adds what one frame's pairs come to. Exact answers are the reference's.
void judge_in_floats(const SceneGeometry& geometry, const LatticePose& pose, const Contacts& contacts,
                     FloatOpinion& into);

}  // namespace palpate::equivalence
