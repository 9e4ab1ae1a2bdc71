#include "compute/gpu/frame/scene_buffers.h"

#include <utility>

#include "shaders/shared/frame_field.h"

namespace palpate {

void name_scene(const PreparedScene& scene, FrameBuffers& buffers) {
  using namespace gpu;
  const BodyBuffers &m = scene.mockup, &t = scene.tool;
  const PartitionBuffers& fine = scene.fine.brick_slot ? scene.fine : t.partition;
  const std::pair<std::int32_t, const VulkanBuffer*> all[] = {
      {kBindScene, &scene.scene},
      {kBindMockupVertices, &m.vertices},
      {kBindMockupTriangles, &m.triangles},
      {kBindMockupInfo, &m.triangle_info},
      {kBindMockupNormals, &m.unit_normal},
      {kBindMockupWeights, &m.field_weight},
      {kBindNeighbourBegin, &m.neighbour_begin},
      {kBindNeighbours, &m.neighbours},
      {kBindMockupPatches, &m.patch},
      {kBindMockupExtras, &m.extras},
      {kBindMockupLevels, &m.levels},
      {kBindMockupBrickSlot, &m.partition.brick_slot},
      {kBindMockupBricks, &m.partition.bricks},
      {kBindMockupListBegin, &m.partition.list_begin},
      {kBindMockupListTriangles, &m.partition.list_triangles},
      {kBindMockupBoundaryPlace, &m.partition.boundary_place},
      {kBindMockupMixedBrick, &m.partition.mixed_brick},
      {kBindToolVertices, &t.vertices},
      {kBindToolTriangles, &t.triangles},
      {kBindToolInfo, &t.triangle_info},
      {kBindToolNormals, &t.unit_normal},
      {kBindToolWeights, &t.field_weight},
      {kBindToolExtras, &t.extras},
      {kBindToolLevels, &t.levels},
      {kBindToolSamples, &t.samples},
      {kBindMockupTree, &m.tree},
      {kBindToolTree, &t.tree},
      {kBindFineBrickSlot, &fine.brick_slot},
      {kBindFineBricks, &fine.bricks},
      {kBindFineListBegin, &fine.list_begin},
      {kBindFineListTriangles, &fine.list_triangles},
      {kBindMockupShells, &m.partition.shells},
      {kBindFineShells, &fine.shells},
      {kBindFineExit, &scene.fine_exit},
      {kBindOccupied, &scene.occupied},
      {kBindListBoxes, &scene.list_boxes},
      {kBindToolNear, &scene.tool_near},
      {kBindSampleBegin, &scene.sample_begin},
      {kBindSamplePoints, &scene.sample_points},
      {kBindSampleIds, &scene.sample_ids},
      {kBindToolSamplePoints, &scene.tool_sample_points},
      {kBindToolSampleEnds, &scene.tool_sample_ends}};
  for (const auto& [binding, buffer] : all)
    if (*buffer) buffers.name(binding, *buffer);  // `paper` has no partition of the tool
}

}  // namespace palpate
