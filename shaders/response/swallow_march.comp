#version 460
// One workgroup: a brick that a tool triangle meets, of a swallowed tool; an invocation takes eight of its voxels. How many half
// voxels along D until each touched V_int voxel is out of V_int?
// Reads triangle bricks, the transformed tool, the partition. Writes swallowed_steps.
// Before: the direction is settled.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/triangle_voxel.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindTriangleBricks, TriangleBrick, triangle_bricks);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slots);
READ(kBindMockupBricks, Brick, mockup_bricks);
EDIT_ONE(kBindResponseState, ResponseState, response);

#define PARTITION(name) mockup_##name
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slots
#define PARTITION_BRICKS mockup_bricks
#include "shaders/lib/partition.glsl"

#include "shaders/lib/budget.glsl"

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
  const uint32_t t = flat_group();
  if (t >= frame_lists[kListTriangleBricks].count || response.swallowed_direction == ivec3(0)) return;
  const TriangleBrick item = triangle_bricks[t];
  const uint32_t slot = mockup_brick_slots[item.brick];
  if (slot == kBrickExternal) return;
  const uvec3 corners = tool_triangles[item.mobile];
  const ivec3 a = tool_world[corners.x], b = tool_world[corners.y], c = tool_world[corners.z];
  const i64vec3 normal = raw_normal(a, b, c);
  const uvec3 n = uvec3(scene.mockup.grid.bricks);
  const ivec3 first = 8 * ivec3(item.brick % n.x, item.brick / n.x % n.y, item.brick / n.x / n.y);
  const int32_t size = scene.mockup.grid.size;
  for (uint32_t z = 0u; z < 8u; ++z) {
    const ivec3 voxel = first + ivec3(gl_LocalInvocationIndex & 7u, gl_LocalInvocationIndex >> 3, z);
    if (mockup_class_of(voxel) != kVoxelInternal) continue;
    const ivec3 low = scene.mockup.grid.origin + voxel * size;
    if (!triangle_touches_box(a, b, c, normal, low, low + size)) continue;
    const uint32_t k = steps_out(low + size / 2, i64vec3(response.swallowed_direction));
    atomicMax(response.swallowed_steps, k);
  }
}
