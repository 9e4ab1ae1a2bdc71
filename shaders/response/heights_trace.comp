#version 460
// One invocation (`refined`): a counting sample. Traces −n_c through the tool.
// Reads samples, slots, areas, the tool: as a whole at its pose, or (WALK) its fine partition. Writes heights, and how they fade in.
// Before: areas_direct, areas_settle.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindClusterBoxes, LatticeBox, cluster_boxes);
READ(kBindRunBoxes, LatticeBox, run_boxes);
READ(kBindToolCorners, ToolCorners, tool_corners);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFineBrickSlot, uint32_t, fine_brick_slot);
READ(kBindFineBricks, Brick, fine_bricks);
READ(kBindFineListBegin, uint32_t, fine_list_begin);
READ(kBindFinePlaces, uint32_t, fine_places);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindSlots, SlotWork, slots);
READ(kBindAreas, AreaWork, areas);
EDIT(kBindHeights, uint32_t, heights);
EDIT(kBindFades, uint32_t, fades);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupNormals, ivec3, mockup_unit_normals);

READ(kBindRayLists, RayList, ray_lists);
READ(kBindRayPlaces, uint32_t, ray_places);

#define TOOL_RAY_LISTS
#include "shaders/lib/tool_ray.glsl"

// H_0 of a sample: how much further, in height, the next sample of the grid lies on the same two faces.
uint32_t fade_height(uint32_t static_id, ivec3 d, uint32_t exit_triangle) {
  const ivec3 n = mockup_unit_normals[static_id], m = tool_normal(exit_triangle);
  const int32_t k = int32_t(mockup_info[static_id] >> kInfoAxisShift & 3u), u = (k + 1) % 3, v = (k + 2) % 3;
  const uint64_t across = uint64_t(abs(n[k]));   // ≥ 2^30 / √3
  const uint64_t along_u = uint64_t(abs(mul_wide(m[u], n[k]) - mul_wide(m[k], n[u]))) / across;   // products within 2^59
  const uint64_t along_v = uint64_t(abs(mul_wide(m[v], n[k]) - mul_wide(m[k], n[v]))) / across;
  const uint64_t leaving = uint64_t(abs(mul_wide(m.x, d.x) + mul_wide(m.y, d.y) + mul_wide(m.z, d.z))) >> 28;
  const uvec3 size = uvec3(abs(d));
  const uint64_t spacing = uint64_t(scene.sample_spacing);   // ≤ 2^28
  const uint64_t most = min((spacing << 32) / uint64_t(max(size.x, max(size.y, size.z))), 1ul << 30);
  return uint32_t(leaving == 0ul ? most : min(most, 4ul * spacing * max(along_u, along_v) / leaving));
}

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListSamples].count) return;
  heights[i] = kNone;
  const uint32_t static_id = frame_samples[i].static_id, area = slots[static_slot[static_id]].area;
  if (area == kNone) return;
  const ivec3 direction = areas[area].direction;
  if (direction == ivec3(0)) return;
  const bool nearest = scene.tool.closed == 0u && scene.tool.has_internal == 0u;
  listed_item = i;
  uint32_t exit_triangle;
  heights[i] = tool_height(frame_samples[i].point, -direction, nearest, exit_triangle);
  if (heights[i] != kNone) fades[i] = fade_height(static_id, direction, exit_triangle);
}
