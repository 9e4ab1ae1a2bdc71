#pragma once
#include <vector>

#include "model/contact/contact_plane.h"
#include "model/contact/contacts.h"
#include "model/lattice/pose.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Most planes that a field gives: four a direction (below).
inline constexpr std::size_t kMostFieldPlanes = 4 * std::size_t{kFieldBins};

/// k', N/m³: pressure for each metre of depth. A flat contact of the scene's reference area has stiffness K.
inline double field_modulus(const SceneGeometry& geometry, double stiffness) {
  return stiffness / geometry.reference_area_m2;
}

/// From the field's integers to force and torque about `gc` (world, m), in double precision; one function for
/// all back ends, so equal sums give equal bits. `stiffness` K in N/m.
Wrench field_wrench(const FieldSums& field, const LatticePose& pose, const SceneGeometry& geometry,
                    double stiffness, const Vec3& gc);

/// The same force as planes, for the control law and for the lone query's solver: each direction of push
/// becomes up to four planes round the centre of what gives way there, at √2 standard deviations along the
/// two main axes across the push, so that stiffness, rocking stiffness, force and torque are those of the
/// sums. Replaces `planes`, which has room for kMostFieldPlanes.
void field_planes(const FieldSums& field, const LatticePose& pose, const SceneGeometry& geometry,
                  double stiffness, const Vec3& gc, std::vector<ContactPlane>& planes);

}  // namespace palpate
