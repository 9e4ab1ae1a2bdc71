#pragma once
#include "model/lattice/lattice.h"
#include "model/lattice/pose.h"
#include "model/scene/scene_geometry.h"
#include "tests/equivalence/random.h"

namespace palpate::equivalence {

/// A pose, any rotation, that brings a point of the tool's surface to within about `reach` voxels of one of
/// the mock-up's: most are in contact. Lattice poses that the host could have made.
LatticePose random_touching_pose(const SceneGeometry& geometry, double reach, Random& random);

/// A pose with a rotation by quarter turns that puts a vertex of the tool exactly on a vertex, an edge or a
/// face of the mock-up, or one step beside it: points on edges, edges in faces, faces on faces.
LatticePose aligned_touching_pose(const SceneGeometry& geometry, Random& random);

/// One of the 24 rotations by quarter turns; translation 0.
LatticePose quarter_turns(Random& random);

/// Half a voxel or less from where the tool was, turned as before.
LatticePose moved_on(const LatticePose& from, std::int32_t voxel, Random& random);

/// The tool's pose, metres, of which this is the lattice pose, but for rounding.
Pose pose_of(const LatticePose& at, const SceneGeometry& geometry);

}  // namespace palpate::equivalence
