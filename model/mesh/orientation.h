#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "model/lattice/lattice_mesh.h"
#include "model/mesh/edges.h"

namespace palpate {

/// A set of triangles connected through edges that carry exactly two triangles, or exactly two of one part of
/// the file (two boxes back to back are two shells, though four triangles meet on the edges of their common
/// face).
struct Shell {
  std::uint32_t first_triangle = 0;
  std::uint32_t triangles = 0;    ///< that did not collapse
  std::uint32_t disagreeing = 0;  ///< triangles turned to agree with the first one
  bool orientable = true;         ///< false: no way of turning makes all its triangles agree; left as given
  bool sheet = false;             ///< winding 0 on both sides
  bool turned = false;            ///< was inside out
};

inline constexpr std::uint32_t kNoShell = 0xFFFFFFFFu;

struct Orientation {
  std::vector<std::uint32_t>
      shell_of;               ///< a triangle's place in `shells`; kNoShell if two of its corners are one
  std::vector<Shell> shells;  ///< by first triangle, ascending
};

/// Turns the mesh so that normals point to the side with winding 0, by exchanging vertices 1 and 2 of
/// triangles, and sets kTriangleTurned (on those exchanged) and kTriangleSheet. Every shell is first made
/// consistent with its first triangle, then judged by rays from up to kOrientationRays of its triangles;
/// exact, deterministic. `part_of`: the part of the file that each triangle came from.
Orientation orient(const EdgeTable& edges, std::span<const std::uint32_t> part_of, LatticeMesh& mesh);

/// Triangles of a shell that vote on its side (chosen).
inline constexpr std::uint32_t kOrientationRays = 64;

/// Whether a triangle that has not collapsed is no sheet's: what is made of sheets alone bounds no inside.
bool has_faces(const LatticeMesh& mesh);

/// Windings on the two sides of a triangle, just off its centroid, the triangle itself and those coplanar
/// with it there left out: the crossings' signs summed along its normal's dominant axis, away from the
/// triangle on either side.
struct SideWinding {
  std::int32_t normal_side = 0;
  std::int32_t back_side = 0;
};

/// The windings of all `triangles` (none collapsed), as the mesh is turned now. docs/EXACTNESS.md section 1.
std::vector<SideWinding> side_windings(const LatticeMesh& mesh, const std::vector<std::uint32_t>& triangles);

}  // namespace palpate
