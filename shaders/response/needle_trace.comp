#version 460
// One workgroup: a tool vertex near a needle; an invocation a share of C_s. How far along n_c does the vertex leave the area's surface?
// Reads needle vertices, C_s, areas. Writes sums of areas; empties the needle table.
// Before: needle_pairs; its list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindToolVertices, ivec3, tool_vertices);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindSlots, SlotWork, slots);
EDIT(kBindAreas, AreaWork, areas);
EDIT(kBindNeedleTable, uint32_t, needle_table);
READ(kBindNeedleVertices, NeedleVertex, needle_vertices);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/ray.glsl"
#include "shaders/lib/height_sum.glsl"

shared uint32_t lowest;

void main() {
  const uint32_t i = flat_group();
  if (i >= frame_lists[kListNeedleVertices].count) return;   // the whole workgroup
  const NeedleVertex item = needle_vertices[i];
  if (gl_LocalInvocationIndex == 0u) {
    needle_table[item.entry] = 0u;
    lowest = kNone;
  }
  barrier();

  const ivec3 p = world_from_tool(tool_vertices[item.vertex]), d = areas[item.area].direction;
  const uint32_t count = frame_lists[kListContactStatics].count;
  if (count > kLoopBudget * kGroupSize) atomicOr(frame_state.overflow_other, kOverflowLoop);
  for (uint32_t slot = gl_LocalInvocationIndex; slot < min(count, kLoopBudget * kGroupSize); slot += kGroupSize) {
    if (slots[slot].area != item.area) continue;
    const uint32_t id = contact_statics[slot];
    if ((static_state[id] & kStaticHit) == 0u) continue;
    const uvec3 corners = mockup_triangles[id];
    const Crossing crossing = ray_crossing(p, d, mockup_vertices[corners.x], mockup_vertices[corners.y], mockup_vertices[corners.z]);
    const bool counts = crossing.sign > 0 || (crossing.sign < 0 && (mockup_info[id] & kInfoSheet) != 0u);
    if (counts) atomicMin(lowest, crossing.height);
  }
  barrier();
  const uint32_t height = lowest;
  if (gl_LocalInvocationIndex != 0u || height == kNone) return;
  HeightSum sum = height_sum_empty();
  height_sum_add(sum, p + ivec3((i64vec3(d) * int64_t(height)) >> 30), height, 1u << 30, 0u);
  height_sum_flush(item.area, sum);
}
