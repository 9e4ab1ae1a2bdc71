#pragma once
#include <cstdint>

#include "model/response.h"
#include "service/plane_set.h"

namespace palpate {

/// What the collision worker hands to the control loop: plain data of fixed size, copied through a mailbox.
struct LawResult : PlaneSet {
  std::int64_t tick = -1;             ///< at which the pose was sensed; −1: no result
  Wrench wrench;                      ///< sum over areas, torque about gc
  bool contact = false;
  std::uint32_t areas = 0;            ///< areas with a force, before the merge below
};

/// Fills everything but tick and pose. `stiffness` K in N/m.
/// κ = K·∂d/∂h: how the mean height changes with the largest, estimated from their ratio ρ = d/h as ρ + 3 (ρ − ½)₊ (1 − ρ), within
/// [K/4, K]. That is exact for a flat contact (1) and a corner (⅓) and 0 to 1.3 % above for a sphere up to half its radius deep (½ to 0.63).
/// Above is the good side: with results c ticks old a κ of 0.95 times the contact's own stiffness loses most of the stable K.
/// More areas than planes: the largest forces keep their planes; the rest share the last one, along their summed force, with their
/// summed torque and κ = Σ κ (n·n_a)²; it is exact at the result's pose, and can't pull either. (Lost: a rest whose forces cancel
/// keeps no plane, its couple is left out.) Never allocates.
void fill_law_result(const ContactResponse& response, double stiffness, LawResult& out);

}  // namespace palpate
