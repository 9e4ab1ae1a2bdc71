#version 460
// One invocation: a touched V_bnd voxel (`paper`). Adds its centre to every area that has a triangle in its
// list.
// Reads touched voxels, the voxels' lists, static states and slots, slot_areas. Writes areas[].voxel_sum and
// voxel_count.
// Before: areas_gather.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindTouchedVoxels, FrameVoxel, touched_voxels);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindMockupListTriangles, uint32_t, mockup_list);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindSlotAreas, uint32_t, slot_areas);
EDIT(kBindAreas, AreaWork, areas);

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListTouchedVoxels].count) return;
  const FrameVoxel touched = touched_voxels[i];
  const i64vec3 centre =
      i64vec3(scene.mockup.grid.origin + touched.voxel * scene.mockup.grid.size + scene.mockup.grid.size / 2);
  uint32_t seen[kMaxFrameAreas / 32u];
  for (uint32_t w = 0u; w < kMaxFrameAreas / 32u; ++w) seen[w] = 0u;
  const uint32_t begin = mockup_list_begin[touched.boundary], end = mockup_list_begin[touched.boundary + 1u];
  if (end - begin > kLoopBudget) atomicOr(frame_state.overflow_other, kOverflowLoop);
  for (uint32_t e = begin; e < min(end, begin + kLoopBudget); ++e) {
    const uint32_t id = mockup_list[e];
    if (static_state[id] == 0u) continue;
    const uint32_t area = slot_areas[static_slot[id]];
    if (area == kNone || (seen[area >> 5] >> (area & 31u) & 1u) != 0u) continue;
    seen[area >> 5] |= 1u << (area & 31u);
    atomicAdd(areas[area].voxel_count, 1u);
    for (int k = 0; k < 3; ++k) atomicAdd(areas[area].voxel_sum[k], centre[k]);
  }
}
