#version 460
// One invocation: a slot of C_s. It is an area of its own to begin with.
// Reads nothing. Writes parents, slot_areas.
// Before: the list of C_s is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/union_nodes.glsl"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindParents, uint32_t, parents);
EDIT(kBindSlotAreas, uint32_t, slot_areas);

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  parents[area_node(slot)] = area_node(slot);
  if (ZONES) parents[zone_node(slot)] = zone_node(slot);
  slot_areas[slot] = kNone;
}
