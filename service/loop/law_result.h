#pragma once
#include <cstdint>

#include "model/contact/response.h"
#include "service/loop/plane_set.h"

namespace palpate {

/// What the collision worker hands to the control loop: plain data of fixed size, copied through a mailbox.
struct LawResult : PlaneSet {
  std::int64_t tick = -1;  ///< at which the pose was sensed; −1: no result
  Wrench wrench;           ///< sum over areas, torque about gc
  bool field = false;      ///< of profile `refined`, which a spring of its own bounds (Couplings)
  std::uint32_t change =
      0;  ///< counts changes of profile or device: with another number the force fades in anew
  bool contact = false;
  std::uint32_t areas = 0;  ///< areas with a force, before the merge below
};

/// How much firmer than the field says its planes are for the law. Planes leave out how facets turn and how a
/// push along n gives way across n (n·u < 1, EXACTNESS section 8), so they say too little where a corner or a
/// tilted peg presses; and what a late result says too little of, the loop is driven by (docs/CONTROL.md).
/// Too much is no harm behind the spring: the tool comes to its place a result later (measured: a corner
/// behind 1500 N/m, results 10 ticks old, needs more than 1.5; a contact as soft as the spring is carried on
/// a third too stiffly until the next result).
inline constexpr double kFirmer = 2;

/// The planes of `refined` (ContactResponse::planes) as a set of fixed size, but for its pose: beyond
/// kMaxLawPlanes, those most alike are made one.
void fill_planes(const ContactResponse& response, PlaneSet& out);

/// Fills everything but tick and pose. `field`: of profile `refined`, whose planes are the response's own;
/// areas have none there. `stiffness` K in N/m. κ = K·∂d/∂h, within [K/4, K]: AreaResponse::slope, the exact
/// derivative of the sums that d is made of, for with results c ticks old a κ of 0.95 times the contact's own
/// stiffness loses most of the stable K. More areas than planes: the largest forces keep their planes; the
/// rest share the last one, along their summed force, with their summed torque and κ = Σ κ (n·n_a)²; it is
/// exact at the result's pose, and can't pull either. (Lost: a rest whose forces cancel keeps no plane, its
/// couple is left out.) Never allocates.
void fill_law_result(const ContactResponse& response, bool field, double stiffness, LawResult& out);

}  // namespace palpate
