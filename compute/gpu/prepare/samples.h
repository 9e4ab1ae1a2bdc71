#pragma once
#include "compute/gpu/prepare/partition.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/gpu/prepare/steps.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Lists the mock-up's samples and first corners, voxel by voxel: they do not depend on the pose. Leaves
/// `out.samples` empty where they do not fit a buffer; a frame then works them out itself. `pairs`: of the
/// mock-up.
void list_samples(PrepareSteps& steps, const SceneGeometry& geometry, const VoxelPairs& pairs,
                  PreparedScene& out);

/// Lists the tool's grid samples that the field may count, triangle by triangle, in its own frame. Leaves
/// `out.tool_sample_points` empty where there are too many.
void list_tool_samples(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out);

/// What frames ask of a closed tool before they count windings: a partition of it in voxels a quarter as
/// wide, the way out of each of its boundary voxels, and which voxels of the tool's own grid are near to its
/// solid. Where a finer partition is not worth its memory, `out.fine` stays empty and the tool's own serves.
void refine_tool(PrepareSteps& steps, const SceneGeometry& geometry, PreparedScene& out);

}  // namespace palpate
