#pragma once
#include <cstdint>
#include <random>

#include "model/lattice.h"
#include "model/scene_geometry.h"

namespace palpate {

/// A pose, any rotation, that brings a point of the tool's surface to within about `reach` voxels of one of the mock-up's: most are
/// in contact. Lattice poses that the host could have made.
LatticePose random_touching_pose(const SceneGeometry& geometry, double reach, std::mt19937_64& random);

/// A pose with a rotation by quarter turns that puts a vertex of the tool exactly on a vertex, an edge or a face of the mock-up, or one
/// step beside it: points on edges, edges in faces, faces on faces.
LatticePose aligned_touching_pose(const SceneGeometry& geometry, std::mt19937_64& random);

}  // namespace palpate
