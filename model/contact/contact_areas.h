#pragma once
#include "model/contact/contacts.h"
#include "model/lattice/lattice.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// `refined`: joins CST and EST into areas for people to look at, from Contacts::carriers; no force hangs on
/// it. Replaces `contacts.areas`, ascending by id. One function for every back end, integers throughout
/// (docs/EXACTNESS.md section 5). Allocates as areas grow.
void gather_areas(const SceneGeometry& geometry, const LatticePose& pose, Contacts& contacts);

/// Scales S ≠ 0 until its largest component lies in [2^28, 2^29).
Int3 lattice_direction(const Long3& sum);

}  // namespace palpate
