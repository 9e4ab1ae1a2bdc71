#pragma once
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/scene/scene.h"
#include "model/scene/scene_geometry.h"
#include "tests/equivalence/case.h"

namespace palpate::queries {

/// A scene to ask about, with poses about contact: some in it, some near, a few far.
struct Subject {
  std::string name;
  SceneGeometry geometry;
  std::vector<Pose> path;  ///< of its device; may be empty
};

/// Of a scene file, in `refined`.
Result<Subject> subject_of_file(const std::string& path);

/// `count` poses: chains of eight, each a little further than the one before, that begin within `reach`
/// voxels of the surface.
std::vector<LatticePose> poses_near(const SceneGeometry& geometry, std::size_t count, double reach,
                                    std::uint64_t seed);

/// `count` poses evenly along a path, each moved by up to `reach` voxels an axis and turned by up to `reach`
/// hundredths.
std::vector<LatticePose> poses_along(const Subject& subject, std::size_t count, double reach,
                                     std::uint64_t seed);

}  // namespace palpate::queries
