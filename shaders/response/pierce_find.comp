#version 460
// One invocation: a counting sample with a height H. Which other areas' surfaces does its ray leave first, before H?
// Reads samples, heights, slots, areas, C_s. Writes areas[].pierces, pierces.
// Before: heights_trace, pierce_boxes. Runs only with several areas.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindHeights, uint32_t, heights);
READ(kBindSlotBoxes, LatticeBox, slot_boxes);
READ(kBindSlots, SlotWork, slots);
READ_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindResultPierces, AreaPierce, pierces);

#include "shaders/lib/pierce.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListSamples].count || heights[i] == kNone) return;
  find_pierced(slots[static_slot[frame_samples[i].static_id]].area, frame_samples[i].point, heights[i]);
}
