#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "compute/scene/scene_tables.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// What shaders/lib/broad_phase/occupied.glsl reads: for ranges of any size whether a voxel of theirs may not
/// be V_ext. About 4 bytes a brick and 256 for each near the surface.
std::vector<std::uint32_t> occupied_words(const PartitionView& mockup);

/// A body's tree, as gpu::kBindMockupTree has it. Cancelled: a header that says there is nothing.
std::vector<std::uint32_t> tree_words(const LatticeMesh& mesh, const std::function<bool()>& go_on);

/// What gpu::kBindListBoxes is.
std::vector<std::uint32_t> list_boxes(const LatticeMesh& mesh, const PartitionView& mockup);

}  // namespace palpate
