#version 460
#extension GL_GOOGLE_include_directive : require
// Whether a triangle touches a voxel, or a brick that is all V_int, exactly. An invocation a TouchCandidate.
// Reads tool_records; sets kMobileInternal or kMobileBoundary; a touched V_bnd voxel enters touched_voxels
// once, and its list goes to static_chunks.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindTouchCandidates, u64vec2, touch_candidates);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindTouchedVoxels, uvec4, touched_voxels);
EDIT(kBindStaticChunks, uvec2, static_chunks);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"
GROUP_COUNTS(kBindListedGroups, listed_groups)

void decide(uint32_t item) {
  if (item >= frame_input.touch_candidates) return;
  const u64vec2 work = touch_candidates[item];   // TouchCandidate
  const uint32_t place = uint32_t(work.x), boundary = uint32_t(work.x >> 32), xy = uint32_t(work.y),
                 z = uint32_t(work.y >> 32);
  const RecordCorners r = record_at(place);
  const ivec3 a = world_from_tool(r.a), b = world_from_tool(r.b), c = world_from_tool(r.c);
  const ivec3 voxel = ivec3(xy & 0xFFFFu, xy >> 16, z & ~uint32_t(kWholeBrick));
  const int32_t size = scene.mockup.grid.size, side = (z & uint32_t(kWholeBrick)) != 0u ? 8 * size : size;
  const ivec3 low = scene.mockup.grid.origin + size * voxel;
  if (!triangle_touches_box(a, b, c, raw_normal(a, b, c), low, low + side)) return;
  const bool internal = INTERNAL && boundary == kNoVoxel;
  mark_mobile(r.id, internal ? kMobileInternal : kMobileBoundary);
  if (internal || (atomicOr(voxel_state[boundary], kVoxelTouched) & kVoxelTouched) != 0u) return;

  const uint32_t at = take_room(kListTouchedVoxels, 1u);
  if (at < frame_lists[kListTouchedVoxels].capacity) {
    touched_voxels[at] = uvec4(boundary, voxel);
    if (begins_group(at, 1u)) grow_result_groups(0u, groups_to(at + 1u));
  }
  const uint32_t begin = mockup_list_begin[boundary];
  uint32_t end = mockup_list_begin[boundary + 1u];
  const uint32_t chunk = chunk_of(end - begin, kStaticChunk, kMostStaticChunks);
  if (chunk > kLoopBudget) {   // the invocation of a chunk could run beyond the budget
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    end = begin;
  }
  const uint32_t chunks = (end - begin + chunk - 1u) / chunk;
  if (chunks == 0u) return;
  const uint32_t first = take_room(kListStaticChunks, chunks),
                 capacity = frame_lists[kListStaticChunks].capacity;
  if (first < capacity && begins_group(first, chunks))
    grow_listed_groups(kGroupsStatics, groups_to(min(first + chunks, capacity)));
  for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListStaticChunks].capacity; ++i)
    static_chunks[first + i] = uvec2(begin + i * chunk, min(begin + (i + 1u) * chunk, end));
}

void main() { decide(flat_invocation()); }
