#version 460
// One invocation: a slot of C_s. Every root of an area takes a number and an empty record.
// Reads parents. Writes areas, slot_areas[root], response.areas.
// Before: areas_join.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/union_nodes.glsl"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindParents, uint32_t, parents);
EDIT_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindSlotAreas, uint32_t, slot_areas);

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count || parents[area_node(slot)] != area_node(slot)) return;
  const uint32_t area = atomicAdd(response.areas, 1u);
  if (area >= kMaxFrameAreas) {
    atomicOr(frame_state.overflow_other, kOverflowAreas);
    return;
  }
  slot_areas[slot] = area;

  const int64_t zero[3] = {0l, 0l, 0l};
  AreaWork empty;
  empty.static_sum = zero;
  empty.mobile_sum = zero;
  empty.height_sum = 0l;
  empty.voxel_sum = zero;
  empty.box_low = ivec3(0x7FFFFFFF);
  empty.box_high = ivec3(-0x7FFFFFFF);
  empty.direction = ivec3(0);
  empty.id = contact_statics[slot];
  empty.zones = 0u;
  empty.flags = 0u;
  empty.rays = 0u;
  empty.max_height = 0u;
  empty.voxel_count = 0u;
  empty.padding = 0u;
  areas[area] = empty;
}
