#pragma once
#include <array>
#include <cstdint>

#include "model/pose.h"

namespace palpate {

/// Planes that a result carries to the force law. Scenes of the chapter reach 4 areas at once; 32 keeps a result at 2 kB.
inline constexpr std::uint32_t kMaxLawPlanes = 32;

/// One contact area as the force law extrapolates it: it pushes along `normal` with
/// max(0, force − stiffness · (normal·Δgc + lever·Δθ)), Δ the motion since the set's pose. World frame.
struct ContactPlane {
  Vec3 normal{0};        ///< n_c, unit
  Vec3 lever{0};         ///< (cp − gc) × n_c, m: torque about gc per newton
  double force = 0;      ///< K d, N; < 0 for a wall that the tool has left: −κ times how far
  double stiffness = 0;  ///< κ, N/m: how fast the force gives way as the tool is drawn back
};

/// What pushes the tool, and how it gives way. Plain data of fixed size.
struct PlaneSet {
  Vec3 gc{0};                         ///< centre of mass at the set's pose, world, m
  Quat rotation{1, 0, 0, 0};          ///< of that pose, world from tool
  std::uint32_t plane_count = 0;
  std::array<ContactPlane, kMaxLawPlanes> planes{};
};

/// What the planes say at another pose; torque about `gc`. No plane pulls. `grows` false: none pushes harder than at the set's
/// own pose either.
Wrench pushed(const PlaneSet& set, const Vec3& gc, const Quat& rotation, bool grows = true);

/// Force and torque that give way by so much for a displacement of gc and a small turn: rows and columns x y z rx ry rz, N/m, N and N·m.
using StiffnessMatrix = std::array<std::array<double, 6>, 6>;

/// Adds `share` times what `pushed` says, and how that gives way at this pose, −∂(force, torque)/∂(gc, turn): Σ κ J Jᵀ over the planes that
/// push, the lower triangle alone (column ≤ row).
void add_pushed(Wrench& push, StiffnessMatrix& slope, const PlaneSet& set, double share, const Vec3& gc, const Quat& rotation, bool grows = true);

/// Adds `share` of another set's pushes, as they are at the pose of `into`; the wrench of the sum is exact there. Planes that
/// point and turn alike become one, and so do the two most alike when there are more than kMaxLawPlanes: along their summed
/// force, with their summed torque and κ = Σ κ (n·n_a)². Planes that don't push at that pose are left out. Never allocates.
void add_pushes(PlaneSet& into, const PlaneSet& set, double share, bool grows = true);

/// All numbers are finite, and no plane has a negative stiffness.
bool sound(const PlaneSet& set);

}  // namespace palpate
