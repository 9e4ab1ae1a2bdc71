#version 460
#extension GL_GOOGLE_include_directive : require
// V_bnd voxels that may hold a point inside the tool: somewhere near, the tool's partition is not V_ext. A workgroup a brick of
// sample_bricks, an invocation 8 voxels along x. Reads both partitions; appends sample_chunks.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ_ONE(kBindFrameInput, FrameInput, frame_input);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindToolBrickSlot, uint32_t, tool_brick_slot);
READ(kBindToolBricks, Brick, tool_bricks);
READ(kBindSampleBricks, uint32_t, sample_bricks);
EDIT(kBindSampleChunks, SampleChunk, sample_chunks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/sample_chunks.glsl"
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slot
#define PARTITION_BRICKS mockup_bricks
#define PARTITION(name) mockup_##name
#include "shaders/lib/partition.glsl"
#define PARTITION_GRID scene.tool.grid
#define PARTITION_SLOTS tool_brick_slot
#define PARTITION_BRICKS tool_bricks
#define PARTITION(name) tool_##name
#include "shaders/lib/partition.glsl"

// Whether some voxel of the tool's grid between first and last is not V_ext. A voxel's reach spans at most 4 an axis.
bool may_be_inside(ivec3 first, ivec3 last) {
  for (int z = first.z; z <= last.z; ++z)
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x)
        if (tool_class_of(ivec3(x, y, z)) != kVoxelExternal) return true;
  return false;
}

void main() {
  const uint32_t item = flat_group();
  if (item >= frame_lists[kListSampleBricks].count) return;
  const uint32_t number = sample_bricks[item];
  const uint32_t slot = mockup_brick_slot[number];
  const ivec3 brick = 8 * brick_at(number, scene.mockup.grid.bricks);
  const int32_t half_size = scene.mockup.grid.size / 2;
  const ivec3 reach = tool_reach(half_size);
  for (uint32_t i = 0u; i < 8u; ++i) {
    const uint32_t bit = gl_LocalInvocationIndex * 8u + i;
    const uint32_t boundary = mockup_boundary_index_in(slot, bit);
    if (boundary == kNoVoxel) continue;
    const ivec3 voxel = brick + voxel_at(bit);
    const ivec3 centre = tool_from_world(scene.mockup.grid.origin + 2 * half_size * voxel + half_size);
    const ivec3 first = max(tool_voxel_of(centre - reach), ivec3(0));
    const ivec3 last = min(tool_voxel_of(centre + reach), 8 * scene.tool.grid.bricks - 1);
    if (may_be_inside(first, last)) ask_for_samples(voxel, boundary);
  }
}
