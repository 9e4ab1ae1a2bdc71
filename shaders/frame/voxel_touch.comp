#version 460
#extension GL_GOOGLE_include_directive : require
// Whether a triangle touches a voxel, exactly. An invocation a TouchCandidate. Reads mobile_corners; sets kMobileInternal or
// kMobileBoundary; a touched V_bnd voxel enters touched_voxels once, and its list goes to pair_chunks for this triangle.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindMobileCorners, ToolCorners, mobile_corners);
READ(kBindTouchCandidates, uvec4, touch_candidates);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindTouchedVoxels, uvec4, touched_voxels);
EDIT(kBindPairChunks, uvec3, pair_chunks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListTouchCandidates].count) return;
  const uvec4 work = touch_candidates[item];   // TouchCandidate
  const uint32_t mobile = work.x, boundary = work.y;
  const ToolCorners t = mobile_corners[mobile];
  const i64vec3 normal = raw_normal(t.a, t.b, t.c);
  const ivec3 voxel = ivec3(work.z & 0xFFFFu, work.z >> 16, work.w);
  const ivec3 low = scene.mockup.grid.origin + scene.mockup.grid.size * voxel, high = low + scene.mockup.grid.size;
  if (!triangle_touches_box(t.a, t.b, t.c, normal, low, high)) {
    // What is listed in the voxel may be close to the triangle all the same.
    if (boundary != kNoVoxel && triangle_touches_box(t.a, t.b, t.c, normal, low - kCloseSteps, high + kCloseSteps)) frame_state.close = 1u;
    return;
  }
  mark_mobile(mobile, boundary == kNoVoxel ? kMobileInternal : kMobileBoundary);
  if (boundary == kNoVoxel) return;

  const uint32_t begin = mockup_list_begin[boundary];
  uint32_t end = mockup_list_begin[boundary + 1u];
  const uint32_t chunk = chunk_of(end - begin, kPairChunk, kMostPairChunks);
  if (chunk > kLoopBudget / kPairProbes) {   // the invocation of a chunk could run beyond the budget
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    end = begin;
  }
  uint32_t tag = mobile;
  if ((atomicOr(voxel_state[boundary], kVoxelTouched) & kVoxelTouched) == 0u) {
    tag |= kFirstTouch;
    const uint32_t at = atomicAdd(frame_lists[kListTouchedVoxels].count, 1u);
    if (at < frame_lists[kListTouchedVoxels].capacity) touched_voxels[at] = uvec4(boundary, voxel);
  }
  const uint32_t chunks = (end - begin + chunk - 1u) / chunk;
  const uint32_t first = take_room(kListPairChunks, chunks);
  for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListPairChunks].capacity; ++i)
    pair_chunks[first + i] = uvec3(tag, begin + i * chunk, min(begin + (i + 1u) * chunk, end));
}
