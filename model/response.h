#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "model/contacts.h"
#include "model/plan.h"
#include "model/pose.h"
#include "model/scene_geometry.h"

namespace palpate {

/// The contact response of one area (chapter, eq. 3), in double precision, world frame.
struct AreaResponse {
  std::uint32_t id = 0;
  Vec3 normal{0};            ///< n_c, unit, out of the mock-up; 0 if there is no direction
  double depth = 0;          ///< d, m, ≥ 0; of the area that gives force for a pierced plate: the smallest of its group
  double max_depth = 0;      ///< largest height, m
  double slope = 1;          ///< ∂d/∂h: how d changes as the tool goes deeper along n_c; may leave [0, 1] where samples come in
  Vec3 point{0};             ///< cp, m; gc where the plan leaves it out
  Vec3 force{0};             ///< K d n_c, N; 0 for an area silenced by piercing
  Vec3 torque{0};            ///< (cp − gc) × F, N·m
  std::uint32_t flags = 0;   ///< ContactFlag bits
  bool silent = false;       ///< gives no force because another area of the same pierced plate does
};

struct ContactResponse {
  Vec3 gc{0};                ///< centre of mass of the tool at this pose, world, m
  Wrench wrench;             ///< sum over areas
  std::uint32_t flags = 0;
  bool contact = false;
  bool contact_points = true;   ///< as Contacts::contact_points; false: no cp, and all torques are 0
  std::vector<AreaResponse> areas;   ///< as Contacts::areas; a swallowed tool gives one area with id 0xFFFFFFFF
};

/// Turns integer sums into d, n_c, cp, F, T. One function for both back ends: equal sums give equal bits.
/// `stiffness` K in N/m, finite and ≥ 0. `held`: what query() was given, so that a pierced plate keeps its side; may be null.
/// A truncated frame gives zero force. Writes `out` whole, reusing its memory.
void respond(const Contacts& contacts, const LatticePose& pose, const SceneGeometry& geometry, Profile profile,
             double stiffness, ContactResponse& out, const Held* held = nullptr);

/// What the next frame may hold on to.
void remember(const Contacts& contacts, const ContactResponse& response, Held& held);

}  // namespace palpate
