#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "model/contact/contact_plane.h"
#include "model/contact/contacts.h"
#include "model/lattice/pose.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// The contact response of one area (chapter, eq. 3), in double precision, world frame.
struct AreaResponse {
  std::uint32_t id = 0;
  Vec3 normal{0};        ///< n_c, unit, out of the mock-up; 0 if there is no direction
  double depth = 0;      ///< d, m, ≥ 0: the mean of what its samples find
  double max_depth = 0;  ///< the largest, m
  double slope = 1;      ///< `paper`: ∂d/∂h, how d changes as the tool goes deeper along n_c
  Vec3 point{0};         ///< cp, m; gc where the plan leaves it out
  Vec3 force{0};  ///< `paper`: K d n_c, N. `refined`: what the mock-up's own samples of the area say, K (area
                  ///< / A_ref) d n_c where it is flat
  Vec3 torque{0};           ///< about gc, N·m
  std::uint32_t flags = 0;  ///< ContactFlag bits
};

/// What a hand would feel at a pose if it had always been there: service/queries/lone_query.h.
struct Felt {
  Wrench wrench;        ///< that the spring hands on; torque about gc at the pose asked for, world
  Pose tool;            ///< where the tool is while the device is at the pose asked for
  int evaluations = 0;  ///< of the field, the one at the pose asked for included
  bool settled = true;  ///< false: no balance was found; the wrench is of the nearest to one
};

/// What a hand feels of a frame: force and torque, and what they are made of.
struct ContactResponse {
  Vec3 gc{0};     ///< centre of mass of the tool at this pose, world, m
  Wrench wrench;  ///< `paper`: sum over areas. `refined`: of the pressure field at this pose, before any
                  ///< coupling
  double max_depth = 0;      ///< `refined`: how deep the deepest sample lies, m; `paper`: 0
  std::optional<Felt> felt;  ///< `refined`, of a lone query; respond() leaves it empty
  std::uint32_t flags = 0;
  bool contact = false;
  bool contact_points = true;        ///< as Contacts::contact_points; false: no cp, and all torques are 0
  std::vector<AreaResponse> areas;   ///< as Contacts::areas
  std::vector<ContactPlane> planes;  ///< `refined`: the field for the control law (field_planes)

  /// What is told as force and torque: what would be felt, where it was asked for.
  const Wrench& told() const { return felt ? felt->wrench : wrench; }
};

/// Turns integer sums into d, n_c, cp, F, T. One function for all back ends: equal sums give equal bits.
/// `stiffness` K in N/m, finite and ≥ 0. A truncated frame gives zero force. Writes `out` whole, reusing its
/// memory.
void respond(const Contacts& contacts, const LatticePose& pose, const SceneGeometry& geometry,
             Profile profile, double stiffness, ContactResponse& out);

}  // namespace palpate
