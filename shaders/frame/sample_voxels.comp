#version 460
#extension GL_GOOGLE_include_directive : require
// V_bnd voxels that may hold a point inside the tool. A workgroup a brick of sample_bricks, an invocation one boundary voxel in 64.
// Reads both partitions; appends sample_chunks: of the listed samples (LISTED = 1), else of the voxel's list of triangles.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"

layout(constant_id = 0) const uint32_t LISTED = 1u;
layout(constant_id = 1) const uint32_t HAS_NEAR = 1u;   // 0: there are no bits, all voxels are near

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindMockupBoundaryPlace, uint32_t, boundary_place);
READ(kBindToolNear, uint32_t, tool_near);
READ(kBindSampleBegin, uint32_t, sample_begin);
READ(kBindSampleBricks, uint32_t, sample_bricks);
EDIT(kBindSampleChunks, SampleChunk, sample_chunks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/sample_chunks.glsl"

// Whether the tool's solid may reach into a voxel with this centre (tool lattice point).
bool near_tool(ivec3 centre) {
  if (HAS_NEAR == 0u) return true;
  // What reaches out of the grid has its nearest voxel of the solid seen from the border: the grid is padded by two voxels.
  const ivec3 n = 8 * scene.fine.bricks, d = centre - scene.fine.origin;
  if (any(lessThan(d, ivec3(-scene.mockup.grid.size))) || any(greaterThan(d, n * scene.fine.size + scene.mockup.grid.size))) return false;
  const uvec3 v = uvec3(clamp(cell_along(d, scene.fine.size, n), ivec3(0), n - 1));
  const uint32_t i = v.x + uint32_t(n.x) * (v.y + uint32_t(n.y) * v.z);
  return (tool_near[i >> 5] >> (i & 31u) & 1u) != 0u;
}

void main() {
  const uint32_t item = flat_group();
  if (item >= frame_lists[kListSampleBricks].count) return;
  const uint32_t number = sample_bricks[item];
  const uint32_t slot = mockup_brick_slot[number];
  const ivec3 brick = 8 * brick_at(number, scene.mockup.grid.bricks);
  const int32_t size = scene.mockup.grid.size;
  const uint32_t begin = mockup_bricks[slot].first[0], end = mockup_bricks[slot].first[15] + uint32_t(bitCount(mockup_bricks[slot].boundary[15]));
  for (uint32_t boundary = begin + gl_LocalInvocationIndex; boundary < end; boundary += kGroupSize) {
    const ivec3 voxel = brick + voxel_at(boundary_place[boundary] & 511u);
    if (!near_tool(tool_from_world(scene.mockup.grid.origin + size * voxel + size / 2))) continue;
    if (LISTED != 0u) ask_for_listed(sample_begin[mockup_list_begin[boundary]], sample_begin[mockup_list_begin[boundary + 1u]]);
    else ask_for_samples(voxel, boundary);
  }
}
