#include "compute/prepared_scene.h"

namespace palpate {

std::uint64_t PreparedScene::memory_bytes() const {
  std::uint64_t sum = scene.bytes();
  for (const BodyBuffers* body : {&mockup, &tool}) {
    const PartitionBuffers& p = body->partition;
    for (const VulkanBuffer* b :
         {&body->vertices, &body->triangles, &body->triangle_info, &body->unit_normal, &body->sample_weight, &body->neighbour_begin,
          &body->neighbours, &body->seam_begin, &body->seams, &p.brick_slot, &p.bricks, &p.mixed_brick, &p.boundary_place,
          &p.list_begin, &p.list_triangles})
      sum += b->bytes();
  }
  return sum;
}

Result<PreparedScene> prepare_scene(VulkanDevice&, const SceneGeometry&, const Plan&, const Progress&) {
  return Error{ErrorCode::kInternal, "preparation is not written yet"};
}

Result<VoxelPartition> read_partition(VulkanDevice&, const PartitionBuffers&) {
  return Error{ErrorCode::kInternal, "preparation is not written yet"};
}

}  // namespace palpate
