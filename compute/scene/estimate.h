#pragma once
#include <cstdint>

#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Bytes of device memory that preparing and keeping a scene takes at most, from the geometry alone: both
/// bodies as they are, and the lists of voxels from areas and edges as the choice of the voxel size estimates
/// them. tests/compute/preparation_gpu_test holds it against what was taken.
std::uint64_t estimate_preparation(const SceneGeometry& geometry, const Plan& plan);

}  // namespace palpate
