#pragma once
#include <cstdint>
#include <memory>

#include "compute/scene/partition.h"
#include "compute/vulkan/buffer.h"
#include "compute/vulkan/device.h"
#include "model/collision_backend.h"
#include "model/result.h"
#include "model/scene/plan.h"
#include "model/scene/scene_geometry.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// A voxel partition on the device (docs/EXACTNESS.md section 2); look-ups in shaders/lib/partition.glsl.
struct PartitionBuffers {
  gpu::GridConstants grid{};
  VulkanBuffer brick_slot;   ///< uint32, one a brick: place in `bricks`, or kBrickExternal / kBrickInternal
  VulkanBuffer bricks;       ///< gpu::Brick, one a mixed brick, ascending brick number
  VulkanBuffer mixed_brick;  ///< uint32, one a mixed brick: its brick number
  VulkanBuffer boundary_place;  ///< uint32, one a boundary voxel: slot · 512 + bit; ascending
  VulkanBuffer list_begin;      ///< uint32, CSR over boundary voxels, + 1
  VulkanBuffer list_triangles;  ///< uint32 ids, ascending in each voxel
  VulkanBuffer shells;  ///< kBindMockupShells of shaders/shared/frame_field.h (EXACTNESS.md section 4, "Vote"
                        ///< and "Doubt"); empty where nobody asks
  bool has_internal = false;
};

/// One body on the device. Numbers of entries are in gpu::BodyConstants.
struct BodyBuffers {
  VulkanBuffer vertices;         ///< ivec3
  VulkanBuffer triangles;        ///< uvec3, vertex indices
  VulkanBuffer triangle_info;    ///< uint32: flags and sample axis (kInfo… in shaders/shared/scene.h)
  VulkanBuffer unit_normal;      ///< ivec3, Q30
  VulkanBuffer field_weight;     ///< uint32, Q30; `refined`
  VulkanBuffer patch;            ///< uint32; mock-up only, `refined`
  VulkanBuffer extras;           ///< gpu::ExtraSample, ascending by triangle; `refined`
  VulkanBuffer levels;           ///< uint32: kBindMockupLevels in shaders/shared/frame_field.h; `refined`
  VulkanBuffer samples;          ///< uint32, one a triangle: LatticeMesh::grid_samples; tool only, `refined`
  VulkanBuffer tree;             ///< texels: kTreeHeadTexels in shaders/shared/scene.h; `refined`
  VulkanBuffer neighbour_begin;  ///< uint32, CSR over triangles, + 1; mock-up only
  VulkanBuffer neighbours;       ///< uint32: id · 2 + smooth; mock-up only
  PartitionBuffers partition;    ///< empty for the tool in `paper`
};

/// What preparation leaves on the device, and every frame reads. Buffers without entries are 4 bytes, so that
/// each can always be bound.
struct PreparedScene {
  gpu::SceneConstants constants{};
  VulkanBuffer scene;  ///< constants, as a storage buffer
  BodyBuffers mockup;
  BodyBuffers tool;
  PartitionBuffers fine;   ///< of a closed tool, in finer voxels; may be empty: then the tool's own serves
  VulkanBuffer fine_exit;  ///< uint32, one a boundary voxel of it: kBindFineExit
  VulkanBuffer tool_near;  ///< a bit a voxel of the fine grid: a mock-up voxel with its centre there may meet
                           ///< the tool's solid; may be empty: all may
  VulkanBuffer occupied;   ///< uint32: kBindOccupied
  VulkanBuffer list_boxes;     ///< uint32, one an entry of the mock-up's lists: kBindListBoxes
  VulkanBuffer sample_begin;   ///< uint32, by boundary voxel of the mock-up, + 1; with the next two empty
                               ///< where there is too much of them: frames work samples out
  VulkanBuffer sample_points;  ///< uint32: kBindSamplePoints
  VulkanBuffer sample_ids;     ///< uint32, one a point
  VulkanBuffer tool_sample_points;  ///< texels: kBindToolSamplePoints; with the next one empty where there
                                    ///< are too many: frames work them out
  VulkanBuffer tool_sample_ends;    ///< texels: kBindToolSampleEnds
  std::uint64_t memory_bytes() const;
};

/// Calls visit(partition) for each partition of a prepared scene, const or not; always in the same order.
template <class Scene, class Visit>
void for_each_partition(Scene& scene, Visit visit) {
  visit(scene.mockup.partition);
  visit(scene.tool.partition);
  visit(scene.fine);
}

/// Calls visit(buffer) for each buffer of a prepared scene that is worked out, const or not; always in the
/// same order. Some may be empty.
template <class Scene, class Visit>
void for_each_made_buffer(Scene& scene, Visit visit) {
  visit(scene.scene);
  for_each_partition(scene, [&](auto& p) {
    for (auto* buffer : {&p.brick_slot, &p.bricks, &p.mixed_brick, &p.boundary_place, &p.list_begin,
                         &p.list_triangles, &p.shells})
      visit(*buffer);
  });
  for (auto* buffer :
       {&scene.fine_exit, &scene.tool_near, &scene.occupied, &scene.list_boxes, &scene.sample_begin,
        &scene.sample_points, &scene.sample_ids, &scene.tool_sample_points, &scene.tool_sample_ends,
        &scene.mockup.tree, &scene.tool.tree})
    visit(*buffer);
}

/// The same for all buffers: also those that hold the meshes as they are.
template <class Scene, class Visit>
void for_each_buffer(Scene& scene, Visit visit) {
  for_each_made_buffer(scene, visit);
  for (auto* body : {&scene.mockup, &scene.tool})
    for (auto* buffer : {&body->vertices, &body->triangles, &body->triangle_info, &body->unit_normal,
                         &body->field_weight, &body->patch, &body->extras, &body->levels, &body->samples,
                         &body->neighbour_begin, &body->neighbours})
      visit(*buffer);
}

/// Builds both bodies and their partitions. Errors: memory (kBadValue, one sentence), cancelled, device lost.
Result<PreparedScene> prepare_scene(VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan,
                                    const Progress& progress);

/// Fills the buffers that hold the meshes as they are; the others stay empty.
Result<void> upload_meshes(VulkanDevice& device, const SceneGeometry& geometry, const Plan& plan,
                           PreparedScene& out);

/// The same scene for another device that shares host memory (VulkanDevice::shares_memory): no copy is made.
Result<PreparedScene> share_scene(VulkanDevice& device, const PreparedScene& scene);

/// Reads a partition back.
Result<Partition> read_partition(VulkanDevice& device, const PartitionBuffers& partition);

}  // namespace palpate
