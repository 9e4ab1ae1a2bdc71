#pragma once
#include <cstdint>
#include <vector>

#include "compute/scene/scene_tables.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Side of the voxels, steps, of a second, finer partition of a closed tool, for early answers about samples;
/// 0: it is not worth its memory. `own`: the tool's first partition.
std::int32_t fine_voxel_size(const SceneGeometry& geometry, const gpu::GridConstants& own);

/// By boundary voxel of a closed tool's partition: the axis step that leads out of the solid through the
/// fewest boundary voxels (kBindFineExit).
std::vector<std::uint32_t> ways_out(const PartitionView& partition);

/// A bit a voxel: its centre is within half a mock-up voxel's diagonal of the tool's solid, from a centre
/// anywhere in the voxel. Empty: it would take too much memory. `voxel_size`: of the mock-up.
std::vector<std::uint32_t> near_tool(const PartitionView& partition, std::int32_t voxel_size);

}  // namespace palpate
