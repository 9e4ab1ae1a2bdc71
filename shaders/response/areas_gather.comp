#version 460
// One invocation: a slot of C_s. Adds its triangle to its area: box, zones, the sum of static normals.
// Reads parents, slot_areas, the mock-up's triangles. Writes areas, slot_areas, area and zone of the statics'
// results.
// Before: areas_number.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupNormals, ivec3, mockup_unit_normals);
layout(set = 0, binding = kBindParents, scalar) coherent buffer parents_block { uint32_t parents[]; };
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindSlotAreas, uint32_t, slot_areas);
EDIT(kBindResultStatics, StaticResult, result_statics);

#include "shaders/lib/union_find.glsl"

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  const uint32_t id = contact_statics[slot];
  const uint32_t root = slot_of_node(union_root(area_node(slot)));
  const uint32_t zone = ZONES ? slot_of_node(union_root(zone_node(slot))) : root;
  tell_spent();
  const uint32_t area = slot_areas[root];
  result_statics[slot].area = area;
  result_statics[slot].zone = zone;
  if (area == kNone) return;   // beyond the capacity of areas
  if (slot != root) slot_areas[slot] = area;

  const uvec3 corners = mockup_triangles[id];
  const ivec3 a = mockup_vertices[corners.x], b = mockup_vertices[corners.y], c = mockup_vertices[corners.z];
  for (int k = 0; k < 3; ++k) {
    atomicMin(areas[area].box_low[k], min(min(a[k], b[k]), c[k]));
    atomicMax(areas[area].box_high[k], max(max(a[k], b[k]), c[k]));
  }
  if (zone == slot) atomicAdd(areas[area].zones, 1u);
  const ivec3 n = mockup_unit_normals[id];
  for (int k = 0; k < 3; ++k) atomicAdd(areas[area].static_sum[k], int64_t(n[k]));
}
