#version 460
// One invocation: a slot of C_s. Joins its triangle with its neighbours of smaller id in C_s: into areas over
// every shared edge, into zones over smooth ones.
// Reads the mock-up's neighbours, static states. Writes parents.
// Before: areas_begin.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindNeighbourBegin, uint32_t, neighbour_begin);
READ(kBindNeighbours, uint32_t, neighbours);
layout(set = 0, binding = kBindParents, scalar) coherent buffer parents_block { uint32_t parents[]; };

#include "shaders/lib/union_find.glsl"

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  const uint32_t id = contact_statics[slot];
  for (uint32_t e = neighbour_begin[id]; e < neighbour_begin[id + 1u] && !spent(1u); ++e) {
    const uint32_t other = neighbours[e] >> 1;
    if (other >= id) break;   // ascending: the rest joins from its own side
    if (static_state[other] == 0u) continue;
    const uint32_t to = static_slot[other];
    union_join(area_node(slot), area_node(to));
    if (ZONES && (neighbours[e] & 1u) != 0u) union_join(zone_node(slot), zone_node(to));
  }
  tell_spent();
}
