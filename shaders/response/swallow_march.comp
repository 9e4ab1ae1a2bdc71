#version 460
// One workgroup: a triangle of a swallowed tool near a brick; an invocation takes eight of its voxels. How many half
// voxels along D until each touched V_int voxel is out of V_int?
// Reads near triangles, the transformed tool, the partition. Writes swallowed_steps.
// Before: the direction is settled.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/triangle_voxel.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindNearTriangles, uvec4, near_triangles);
READ(kBindToolRecords, uint64_t, tool_records);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slots);
READ(kBindMockupBricks, Brick, mockup_bricks);
EDIT_ONE(kBindResponseState, ResponseState, response);

#define PARTITION(name) mockup_##name
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slots
#define PARTITION_BRICKS mockup_bricks
#include "shaders/lib/partition.glsl"

#include "shaders/lib/budget.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"

// Smallest k ≥ 1 for which the voxel at centre + ((D·k·(V/2)) >> 29) is not V_int. |D·k·V/2| < 2^29 · 2^31.
uint32_t steps_out(ivec3 centre, i64vec3 d) {
  const int64_t half_voxel = int64_t(scene.mockup.grid.size / 2);
  for (uint32_t k = 1u;; ++k) {
    if (spent(1u)) return k;
    const ivec3 at = centre + ivec3((d * (int64_t(k) * half_voxel)) >> 29);
    if (mockup_class_of(mockup_voxel_of(at)) != kVoxelInternal) return k;
  }
}

void main() {
  if (flat_group() >= frame_input.near_triangles || response.swallowed_direction == ivec3(0)) return;
  const uvec4 work = near_triangles[flat_group()];   // NearTriangle
  const ivec3 first = 8 * ivec3(work.z & 0xFFFFu, work.z >> 16, work.w);
  const uint32_t place = work.x & ~kFirstOfTriangle;
  const int32_t size = scene.mockup.grid.size;
  const RecordCorners r = record_at(place);
  const ToolCorners t = ToolCorners(world_from_tool(r.a), world_from_tool(r.b), world_from_tool(r.c));
  const i64vec3 normal = raw_normal(t.a, t.b, t.c);
  if (normal == i64vec3(0l)) return;
  for (uint32_t z = 0u; z < 8u; ++z) {
    const ivec3 voxel = first + ivec3(gl_LocalInvocationIndex & 7u, gl_LocalInvocationIndex >> 3, z);
    if (mockup_class_of(voxel) != kVoxelInternal) continue;
    const ivec3 low = scene.mockup.grid.origin + voxel * size;
    if (!triangle_touches_box(t.a, t.b, t.c, normal, low, low + size)) continue;
    atomicMax(response.swallowed_steps, steps_out(low + size / 2, i64vec3(response.swallowed_direction)));
  }
}
