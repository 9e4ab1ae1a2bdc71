#pragma once
#include <cstdint>

#include "compute/prepare_partition.h"
#include "compute/prepare_steps.h"
#include "compute/prepared_scene.h"
#include "model/scene_geometry.h"

namespace palpate {

/// Seams of the mock-up (docs/EXACTNESS.md section 5): pairs of triangles that share no edge, make a smooth angle and touch
/// in more than one common corner. Fills seam_begin, seams and seam_entries of `body`; none unless `refined`.
/// Before: the partition's lists and their pairs.
void find_seams(PrepareSteps& steps, const SceneGeometry& geometry, bool refined, const VoxelPairs& pairs, BodyBuffers& body);

/// Most entries of the voxels' lists that are looked at together: so few that their pairs can be counted in 32 bits. At least 1. No list is longer
/// than `longest_list`.
std::uint32_t seam_entries_a_run(std::uint32_t longest_list);

}  // namespace palpate
