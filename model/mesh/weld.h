#pragma once
#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"
#include "model/mesh/mesh.h"
#include "model/result.h"

namespace palpate {

/// Most triangles of one body (chosen: 33 million, some 3 GiB of corners before welding).
inline constexpr std::size_t kMaxTriangles = std::size_t{1} << 25;

/// Snaps every corner to the nearest lattice point and welds equal points. Fills `vertices` (numbered in the
/// order in which triangles first name them), `triangles`, `flags` (collapsed or 0) and the box; nothing
/// else. Errors (kBadValue): an index beyond the vertex list, a coordinate that is not finite or beyond the
/// lattice's reach, too many triangles, no triangle that keeps an area.
Result<LatticeMesh> snap_and_weld(const Mesh& mesh, const Lattice& lattice);

}  // namespace palpate
