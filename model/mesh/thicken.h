#pragma once
#include <cstddef>

#include "model/mesh/enclosure.h"
#include "model/mesh/mesh.h"

namespace palpate {

/// What thicken() makes.
struct Thickened {
  Mesh mesh;
  std::size_t walls = 0;   ///< triangles that became walls; 0: nothing is open
  std::size_t copies = 0;  ///< left out: with the same three corners as an earlier one
  std::size_t spared = 0;  ///< triangles of open pieces that bound an inside, and stay
};

/// An open piece bounds an inside where its enclosure is 98 % of a closed body's, on the mean over its area
/// (chosen: a closed gear is said to have 98.8 %, solids whose faces don't meet 98.8 to 100; of what has
/// holes that a hand would find, the vote of docs/EXACTNESS.md, section 4, is not sure).
inline constexpr double kBoundsAnInside = 0.49;

/// Thicknesses that thicken() takes, m: it tells corners apart by a 4,096th, in 64 bits.
inline constexpr double kThinnestSheet = 1e-6, kThickestSheet = 1;

/// Gives sheets walls. A sheet has no inside, so nothing can lie in it, and two of them can't push each
/// other; as walls they can. A piece is what hangs together over edges that two triangles share. One of which
/// an edge is not shared by two, or that has one side only (Möbius), is open: its triangles move out by half
/// the thickness along their normals, a copy of them, turned over, as far the other way, and its border
/// closes between them. So each is a closed body of its own; edges that three triangles share are borders of
/// all three. Corners closer than a 4,096th of the thickness are one (chosen: nothing that a hand feels).
/// Where triangles meet at an angle corners go as far as the plates' outsides do, but no more than twice half
/// the thickness (chosen, as mitres are cut off).
///
/// Each part of `mesh` stays one: its triangles in their order, then backs in that order, then borders.
/// `thickness_m` ≥ kThinnestSheet, coordinates within 1e9 m. `enclosure`, of `mesh`: open pieces that bound
/// an inside stay as they are, too, and it knows the others for sheets; without one none stays.
Thickened thicken(const Mesh& mesh, double thickness_m, Enclosure* enclosure = nullptr);

}  // namespace palpate
