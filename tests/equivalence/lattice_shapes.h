#pragma once
#include <vector>

#include "model/mesh/mesh.h"
#include "model/result.h"
#include "model/scene/geometry_build.h"
#include "model/scene/scene_geometry.h"

namespace palpate::equivalence {

/// Three lattice points, in the order of a mesh's face.
struct LatticeTriangle {
  Int3 a, b, c;
};
using Triangles = std::vector<LatticeTriangle>;

/// A scene whose metres are lattice steps, so that what is written is what is judged; the tool's frame is its
/// lattice frame. `voxel` even and ≥ 8. `parts`: where each part of the mock-up begins; empty: one part.
Result<SceneGeometry> lattice_scene(const Triangles& mockup, const Triangles& tool, std::int32_t voxel,
                                    std::int32_t spacing, const std::vector<std::size_t>& parts = {});

/// Closed box, outward: face 2·axis + (upper), two triangles each.
Triangles box_of(const Int3& min, const Int3& max);

/// The same triangles seen from the other side.
Triangles flipped(Triangles triangles);

void append(Triangles& into, const Triangles& more);

}  // namespace palpate::equivalence
