#pragma once
#include <cstdint>
#include <string>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/gpu/prepare/steps.h"
#include "compute/scene/scene_tables.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"

namespace palpate {

/// Pairs (triangle, boundary voxel), in no order; what the lists and the crossings are made from.
struct VoxelPairs {
  VulkanBuffer triangle;     ///< uint32
  VulkanBuffer voxel;        ///< uint32, compact index
  VulkanBuffer entry_voxel;  ///< uint32, compact index of the voxel of every entry of list_triangles
  std::uint32_t count = 0;
};

/// Fills everything of `body.partition` but the classes of what is not boundary: bricks, boundary voxels,
/// lists. `growth`: steps by which a voxel grows before it is asked what it touches. `name` opens sentences
/// ("mock-up").
VoxelPairs build_lists(PrepareSteps& steps, const LatticeMesh& mesh, const VoxelGrid& grid,
                       std::int32_t growth, const char* name, BodyBuffers& body);

/// Fails where a voxel lists more triangles than one invocation can ask, as a sample in it must. `name` as in
/// build_lists().
void check_lists(PrepareSteps& steps, const PartitionView& partition, const std::string& name);

/// Sorts each list of a CSR of `entries` distinct-in-their-list numbers: by ranks in chunks, then by merging
/// the chunks of long lists. `entry_voxel`: the list of every entry. Returns a number that no list's length
/// exceeds.
std::uint32_t sort_lists(PrepareSteps& steps, const VulkanBuffer& entry_voxel, const VulkanBuffer& list_begin,
                         VulkanBuffer& lists, std::uint32_t entries);

/// Classes of all voxels that are not boundary: components, votes, V_ext and V_int.
void classify(PrepareSteps& steps, const LatticeMesh& mesh, const VoxelPairs& pairs, BodyBuffers& body);

/// Fills `body.partition.shells` of a body that is not closed. After classify(). Whether it bounds an
/// inside, if it has a face (EXACTNESS.md section 4, "Without inside").
bool count_shells(PrepareSteps& steps, const VoxelPairs& pairs, BodyBuffers& body);

}  // namespace palpate
