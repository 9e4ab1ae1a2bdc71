#version 460
// One invocation: an intersecting pair. If its static triangle's area is a needle: takes the middle of the intersection as a
// sample, looks whom it pierces, and lists the tool triangle's vertices.
// Reads pairs, areas, both bodies, slot boxes. Writes sums of areas, pierces, needle table and vertices.
// Before: areas_follow; pierce_boxes where there are several areas. Runs only if some area is a needle.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindPairs, ContactPair, pairs);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindClusterBoxes, LatticeBox, cluster_boxes);
READ(kBindRunBoxes, LatticeBox, run_boxes);
READ(kBindToolCorners, ToolCorners, tool_corners);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolVertices, ivec3, tool_vertices);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFineBrickSlot, uint32_t, fine_brick_slot);
READ(kBindFineBricks, Brick, fine_bricks);
READ(kBindFineListBegin, uint32_t, fine_list_begin);
READ(kBindFinePlaces, uint32_t, fine_places);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindSlots, SlotWork, slots);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindSlotBoxes, LatticeBox, slot_boxes);
READ_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindResultPierces, AreaPierce, pierces);
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindNeedleTable, uint32_t, needle_table);
EDIT(kBindNeedleVertices, NeedleVertex, needle_vertices);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/edge_crossing.glsl"
#include "shaders/lib/tool_ray.glsl"
#include "shaders/lib/height_sum.glsl"
#include "shaders/lib/pierce.glsl"

struct Span {
  bool any;
  ivec3 low, high;
};

void take_edges(ivec3 from[3], ivec3 to[3], inout Span span) {
  for (uint32_t k = 0u; k < 3u; ++k) {
    ivec3 e;
    if (!edge_crossing(from[k], from[(k + 1u) % 3u], to[0], to[1], to[2], e)) continue;
    span.low = span.any ? min(span.low, e) : e;
    span.high = span.any ? max(span.high, e) : e;
    span.any = true;
  }
}

// Lists (area, vertex) unless it is listed already: the key's place in the table decides.
void list_vertex(uint32_t area, uint32_t vertex) {
  const uint32_t key = (area << 24 | vertex) + 1u;   // 8 and 24 bits; 0 is an empty entry
  const uint32_t mask = uint32_t(needle_table.length()) - 1u;
  uint32_t at = key * 2654435761u;
  at ^= at >> 15;   // the upper bits are the mixed ones
  for (uint32_t probe = 0u; probe < kNeedleProbes; ++probe) {
    at &= mask;
    const uint32_t before = atomicCompSwap(needle_table[at], 0u, key);
    if (before == key) return;
    if (before == 0u) {
      const uint32_t i = atomicAdd(frame_lists[kListNeedleVertices].count, 1u);
      if (i < frame_lists[kListNeedleVertices].capacity) needle_vertices[i] = NeedleVertex(area, vertex, at);
      return;
    }
    ++at;
  }
  atomicOr(frame_state.overflow_other, kOverflowNeedleTable);
}

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListPairs].count) return;
  const ContactPair pair = pairs[i];
  const uint32_t area = slots[static_slot[pair.static_id]].area;
  if (area == kNone || (areas[area].state & kAreaNeedle) == 0u) return;

  const uvec3 sc = mockup_triangles[pair.static_id], mc = tool_triangles[pair.mobile];
  const ivec3 s[3] = {mockup_vertices[sc.x], mockup_vertices[sc.y], mockup_vertices[sc.z]};
  const ivec3 m[3] = {world_from_tool(tool_vertices[mc.x]), world_from_tool(tool_vertices[mc.y]), world_from_tool(tool_vertices[mc.z])};
  Span span = Span(false, ivec3(0), ivec3(0));
  take_edges(s, m, span);
  take_edges(m, s, span);
  if (span.any) {
    const ivec3 middle = (span.low + span.high) >> 1;
    const bool nearest = scene.tool.closed == 0u && scene.tool.has_internal == 0u;
    uint32_t exit_triangle;
    const uint32_t height = tool_height(middle, -areas[area].direction, nearest, exit_triangle);
    if (height != kNone) {
      HeightSum sum = height_sum_empty();
      height_sum_add(sum, middle, height, 1u << 30, 0u);
      height_sum_flush(area, sum);
      if (response.areas > 1u) find_pierced(area, middle, height);
    }
  }
  for (int k = 0; k < 3; ++k) list_vertex(area, mc[k]);
}
