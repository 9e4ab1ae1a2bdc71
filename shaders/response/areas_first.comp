#version 460
// One workgroup for all areas: matches held areas, takes the side of sheets, and finds out who needs mobile normals.
// Reads input, held areas, overlaps. Writes areas, overlaps (back to 0), dispatch of members.
// Before: areas_gather, held_count; the list of members is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/wide_integer.glsl"

layout(constant_id = 0) const bool REFINED = true;

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindDispatches, DispatchArguments, dispatches);
READ(kBindHeldAreas, HeldDirection, held_areas);
EDIT(kBindHeldOverlap, uint32_t, held_overlap);
READ_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/area.glsl"
#include "shaders/lib/pose.glsl"

// The held area with most static triangles in common; the first of equals.
uint32_t match_held(uint32_t area) {
  uint32_t best = kNone, most = 0u;
  for (uint32_t h = 0u; h < frame_input.held_areas; ++h) {
    const uint32_t at = area * frame_input.held_areas + h;
    if (held_overlap[at] > most) {
      most = held_overlap[at];
      best = h;
    }
    held_overlap[at] = 0u;
  }
  return best;
}

// +1 when the tool's centre of mass lies on the side to which the sheets of the area face.
int32_t side_of_tool(uint32_t area) {
  const ivec3 gc = world_from_tool(scene.tool_gc);
  const ivec3 away = 2 * gc - (areas[area].box_low + areas[area].box_high);
  Int128 sum = i128(0l);
  for (int k = 0; k < 3; ++k) sum = i128_add(sum, i64_mul(areas[area].sheet_side[k], int64_t(away[k])));
  return i128_sign(sum) >= 0 ? 1 : -1;
}

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize) {
    bool wants = areas[area].zones > 1u;
    if (REFINED) {
      areas[area].held_area = match_held(area);
      if (areas[area].sheets != 0u) {
        const uint32_t held = areas[area].held_area;
        const int32_t kept = held == kNone ? 0 : held_areas[held].sheet_sign;
        areas[area].sheet_sign = kept != 0 ? kept : side_of_tool(area);
        areas[area].flags |= kAreaFlagSheet | (kept != 0 ? kAreaFlagHeld : 0u);
      }
      const bool proximity = areas[area].cst == 0u && areas[area].samples == 0u;
      if (proximity) {
        areas[area].state |= kAreaProximity;
        areas[area].flags = 0u;
        wants = false;
      } else if (!usable(static_sum(area), areas[area].static_weight) && !usable(bare_sum(area), int64_t(areas[area].cst) << 30)) {
        wants = true;
      }
    }
    if (wants) {
      areas[area].state |= kAreaWantsMobile;
      dispatches[kDispatchMembers] = frame_lists[kListMembers].items;   // whoever writes it, the same value
    }
  }
}
