#pragma once
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Sizes of a surface in lattice steps, in double precision, summed in the order of the triangles.
struct SurfaceMeasure {
  double area = 0;           ///< steps²
  double volume = 0;         ///< steps³, signed, by winding; means something for closed meshes
  double longest_edges = 0;  ///< Σ over triangles of the longest edge, steps
  Vec3 area_centroid{0};     ///< steps
  Vec3 volume_centroid{0};   ///< steps; 0 when the volume is not positive
  double triangles = 0;      ///< that did not collapse
};
/// Of a mesh, by its triangles.
SurfaceMeasure measure(const LatticeMesh& mesh);

/// Radius of gyration of the surface about a point, both in steps: √(∫|x − c|² dA / ∫dA). Exact for each
/// triangle but for rounding, summed in their order; > 0 for a mesh with any area.
double gyration_radius(const LatticeMesh& mesh, const Vec3& centre);

}  // namespace palpate
