#version 460
// One invocation: a counting sample (`paper`: a triangle of C_s and its rounded centroid). Traces −n_c through the tool.
// Reads samples, slots, areas, the tool: as a whole at its pose, or (WALK) its fine partition. Writes heights.
// Before: areas_direct, areas_settle.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 0) const bool REFINED = true;

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
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

#include "shaders/lib/tool_ray.glsl"
#include "shaders/lib/centroid.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[REFINED ? kListSamples : kListContactStatics].count) return;
  heights[i] = kNone;
  uint32_t slot = i;
  ivec3 p;
  if (REFINED) {
    slot = static_slot[frame_samples[i].static_id];
    p = frame_samples[i].point;
  } else {
    const uvec3 corners = mockup_triangles[contact_statics[i]];
    p = rounded_centroid(mockup_vertices[corners.x], mockup_vertices[corners.y], mockup_vertices[corners.z]);
  }
  const uint32_t area = slots[slot].area;
  if (area == kNone) return;
  const ivec3 direction = areas[area].direction;
  if (direction == ivec3(0)) return;
  const bool nearest = !REFINED || (scene.tool.closed == 0u && scene.tool.has_internal == 0u);
  heights[i] = tool_height(p, -direction, nearest);
}
