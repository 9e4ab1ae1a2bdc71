#pragma once
#include <array>
#include <cstdint>

#include "model/contact/contact_plane.h"
#include "model/lattice/pose.h"

namespace palpate {

/// Planes that a result carries to the force law: four a direction for sixteen of the field's directions at
/// once, which keeps a result at 4 kB.
inline constexpr std::uint32_t kMaxLawPlanes = 64;

/// What pushes the tool, and how it gives way. Plain data of fixed size.
struct PlaneSet {
  Vec3 gc{0};                 ///< centre of mass at the set's pose, world, m
  Quat rotation{1, 0, 0, 0};  ///< of that pose, world from tool
  std::uint32_t plane_count = 0;
  std::array<ContactPlane, kMaxLawPlanes> planes{};
};

/// What the planes say at another pose; torque about `gc`. No plane pulls. `grows` false: none pushes harder
/// than at the set's own pose either.
Wrench pushed(const PlaneSet& set, const Vec3& gc, const Quat& rotation, bool grows = true);

/// Appends a plane; where there is no room, it and the one most like it become one: force and torque at the
/// set's pose stay, its stiffness loses what is across.
void add_plane(PlaneSet& into, const ContactPlane& plane);

/// Force and torque that give way by so much for a displacement of gc and a small turn: rows and columns x y
/// z rx ry rz, N/m, N and N·m.
using StiffnessMatrix = std::array<std::array<double, 6>, 6>;

/// Adds `share` times what `pushed` says, and how that gives way at this pose, −∂(force, torque)/∂(gc, turn):
/// Σ κ J Jᵀ over the planes that push, the lower triangle alone (column ≤ row).
void add_pushed(Wrench& push, StiffnessMatrix& slope, const PlaneSet& set, double share, const Vec3& gc,
                const Quat& rotation, bool grows = true);

/// Adds `share` of another set's pushes, as they are at the pose of `into`; the wrench of the sum is exact
/// there. Planes that point and turn alike become one, and so do the two most alike when there are more than
/// kMaxLawPlanes: along their summed force, with their summed torque and κ = Σ κ (n·n_a)². Planes that don't
/// push at that pose are left out. Never allocates.
void add_pushes(PlaneSet& into, const PlaneSet& set, double share, bool grows = true);

/// All numbers are finite, and no plane has a negative stiffness.
bool sound(const PlaneSet& set);

}  // namespace palpate
