#version 460
#extension GL_GOOGLE_include_directive : require
// Whether a triangle touches a voxel, exactly. An invocation a TouchCandidate. Reads tool_world and the partition; sets
// kMobileInternal or kMobileBoundary; a touched V_bnd voxel enters touched_voxels, and its list goes to voxel_chunks (once)
// and to pair_chunks (for this triangle).
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "shaders/lib/voxel_range.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindTouchCandidates, TouchCandidate, touch_candidates);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindTouchedVoxels, FrameVoxel, touched_voxels);
EDIT(kBindVoxelChunks, VoxelChunk, voxel_chunks);
EDIT(kBindPairChunks, PairChunk, pair_chunks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slot
#define PARTITION_BRICKS mockup_bricks
#define PARTITION(name) mockup_##name
#include "shaders/lib/partition.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListTouchCandidates].count) return;
  const TouchCandidate work = touch_candidates[item];
  const uint32_t slot = mockup_brick_slot[work.brick];
  const uint32_t boundary = mockup_boundary_index_in(slot, work.local);
  if (boundary == kNoVoxel && (mobile_state[work.mobile] & kMobileInternal) != 0u) return;   // known already

  const uvec3 t = tool_triangles[work.mobile];
  const ivec3 a = tool_world[t.x], b = tool_world[t.y], c = tool_world[t.z];
  const ivec3 voxel = 8 * brick_at(work.brick, scene.mockup.grid.bricks) + voxel_at(work.local);
  const ivec3 low = scene.mockup.grid.origin + scene.mockup.grid.size * voxel;
  if (!triangle_touches_box(a, b, c, raw_normal(a, b, c), low, low + scene.mockup.grid.size)) return;
  mark_mobile(work.mobile, boundary == kNoVoxel ? kMobileInternal : kMobileBoundary);
  if (boundary == kNoVoxel) return;

  const uint32_t begin = mockup_list_begin[boundary];
  uint32_t end = mockup_list_begin[boundary + 1u];
  const uint32_t pair_chunk = chunk_of(end - begin, kPairChunk, kMostPairChunks), voxel_chunk = chunk_of(end - begin, kVoxelChunk, kMostChunks);
  if (pair_chunk > kLoopBudget / kPairProbes) {   // the invocation of a chunk could run beyond the budget
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    end = begin;
  }
  if ((atomicOr(voxel_state[boundary], kVoxelTouched) & kVoxelTouched) == 0u) {
    const uint32_t at = atomicAdd(frame_lists[kListTouchedVoxels].count, 1u);
    if (at < frame_lists[kListTouchedVoxels].capacity) touched_voxels[at] = FrameVoxel(boundary, voxel);
    const uint32_t chunks = (end - begin + voxel_chunk - 1u) / voxel_chunk;
    const uint32_t first = take_room(kListVoxelChunks, chunks);
    for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListVoxelChunks].capacity; ++i)
      voxel_chunks[first + i] = VoxelChunk(begin + i * voxel_chunk, min(begin + (i + 1u) * voxel_chunk, end));
  }
  const uint32_t chunks = (end - begin + pair_chunk - 1u) / pair_chunk;
  const uint32_t first = take_room(kListPairChunks, chunks);
  for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListPairChunks].capacity; ++i)
    pair_chunks[first + i] = PairChunk(work.mobile, begin + i * pair_chunk, min(begin + (i + 1u) * pair_chunk, end));
}
