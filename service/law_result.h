#pragma once
#include <array>
#include <cstdint>

#include "model/pose.h"
#include "model/response.h"

namespace palpate {

/// Planes that a result carries to the force law. Scenes of the chapter reach 4 areas at once; 32 keeps a result at 2 kB.
inline constexpr std::uint32_t kMaxLawPlanes = 32;

/// One contact area as the force law extrapolates it: it pushes along `normal` with
/// max(0, force − stiffness · (normal·Δgc + lever·Δθ)), Δ the motion since the result's pose. World frame.
struct ContactPlane {
  Vec3 normal{0};        ///< n_c, unit
  Vec3 lever{0};         ///< (cp − gc) × n_c, m: torque about gc per newton
  double force = 0;      ///< K d, N, > 0
  double stiffness = 0;  ///< κ, N/m: how fast the force gives way as the tool is drawn back
};

/// What the collision worker hands to the control loop: plain data of fixed size, copied through a mailbox.
struct LawResult {
  std::int64_t tick = -1;             ///< at which the pose was sensed; −1: no result
  Quat rotation{1, 0, 0, 0};          ///< of that pose, world from tool
  Vec3 gc{0};                         ///< centre of mass at that pose, world, m
  Wrench wrench;                      ///< sum over areas, torque about gc
  bool contact = false;
  std::uint32_t areas = 0;            ///< areas with a force, before the merge below
  std::uint32_t plane_count = 0;
  std::array<ContactPlane, kMaxLawPlanes> planes{};
};

/// Fills everything but tick, rotation and gc. `stiffness` K in N/m.
/// κ = K · clamp(d / d_max, 1/4, 1): d is a mean height, whose change with the largest one is estimated by their ratio (1 for
/// a flat contact, 1/2 for a cap, 1/3 for a corner). More areas than planes: the largest forces keep their planes; the rest
/// share the last one, along their summed force, with their summed torque and κ = Σ κ (n·n_a)²; it is exact at the result's
/// pose, and can't pull either. (Lost: a rest whose forces cancel keeps no plane, its couple is left out.) Never allocates.
void fill_law_result(const ContactResponse& response, double stiffness, LawResult& out);

}  // namespace palpate
