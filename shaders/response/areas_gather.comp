#version 460
// One invocation: a slot of C_s. Adds its triangle to its area: box, counts, sums of static normals.
// Reads parents, slots, the mock-up's triangles. Writes areas, slots[].area, area and zone of the statics' results.
// Before: areas_number, samples_count.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 0) const bool REFINED = true;

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupNormals, ivec3, mockup_unit_normals);
READ(kBindMockupWeights, uint32_t, mockup_weights);
layout(set = 0, binding = kBindParents, scalar) coherent buffer parents_block { uint32_t parents[]; };
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindSlots, SlotWork, slots);
EDIT(kBindResultStatics, StaticResult, result_statics);

#include "shaders/lib/union_find.glsl"

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  const uint32_t id = contact_statics[slot];
  const uint32_t root = slot_of_node(union_root(area_node(slot)));
  const uint32_t zone = ZONES ? slot_of_node(union_root(zone_node(slot))) : root;
  const uint32_t area = slots[root].area;
  result_statics[slot].area = area;
  result_statics[slot].zone = zone;
  if (area == kNone) return;   // beyond the capacity of areas
  if (slot != root) slots[slot].area = area;

  const uvec3 corners = mockup_triangles[id];
  const ivec3 a = mockup_vertices[corners.x], b = mockup_vertices[corners.y], c = mockup_vertices[corners.z];
  for (int k = 0; k < 3; ++k) {
    atomicMin(areas[area].box_low[k], min(min(a[k], b[k]), c[k]));
    atomicMax(areas[area].box_high[k], max(max(a[k], b[k]), c[k]));
  }
  atomicAdd(areas[area].statics, 1u);
  if (zone == slot) atomicAdd(areas[area].zones, 1u);
  const bool hit = (static_state[id] & kStaticHit) != 0u;
  if (hit) atomicAdd(areas[area].cst, 1u);

  const ivec3 n = mockup_unit_normals[id];
  if (!REFINED) {
    for (int k = 0; k < 3; ++k) atomicAdd(areas[area].fixed_sum[k], int64_t(n[k]));
    return;
  }
  const bool sheet = (mockup_info[id] & kInfoSheet) != 0u;
  if (sheet) atomicAdd(areas[area].sheets, 1u);
  const uint32_t samples = slots[slot].samples;
  // A term (w·n̂) >> 30 is within 2^31, a triangle's samples within 2^32: the sums stay within 2^63 for 2^32 samples in all.
  const int64_t k_samples = int64_t(samples);
  const int64_t w = int64_t(mockup_weights[id]);
  for (int k = 0; k < 3; ++k) {
    if (samples != 0u) {
      const int64_t term = k_samples * ((w * int64_t(n[k])) >> 30);
      if (sheet) atomicAdd(areas[area].sheet_sum[k], term);
      else atomicAdd(areas[area].fixed_sum[k], term);
    }
    if (hit) {
      if (sheet) atomicAdd(areas[area].bare_sheet[k], int64_t(n[k]));
      else atomicAdd(areas[area].bare_fixed[k], int64_t(n[k]));
    }
    if (sheet) atomicAdd(areas[area].sheet_side[k], int64_t(n[k]));
  }
  if (samples != 0u) {
    atomicAdd(areas[area].samples, samples);
    atomicAdd(areas[area].static_weight, k_samples * w);
  }
}
