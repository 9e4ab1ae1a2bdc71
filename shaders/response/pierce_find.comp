#version 460
// One invocation: a counting sample with a height H. Which other areas' surfaces does its ray leave first, before H?
// Reads samples, heights, slots, areas, C_s. Writes areas[].pierces, pierces.
// Before: heights_trace, pierce_boxes. Runs only with several areas.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ_ONE(kBindScene, SceneConstants, scene);
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

#include "shaders/lib/ray.glsl"
#include "shaders/lib/line_box.glsl"

uint32_t budget = 0u;   // loop iterations of this invocation

bool spent() {
  if (++budget < kLoopBudget) return false;
  atomicOr(frame_state.overflow_other, kOverflowLoop);
  return true;
}

const uint32_t kAreaWords = kMaxFrameAreas / 32u;

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListSamples].count || heights[i] == kNone) return;
  const uint32_t own = slots[static_slot[frame_samples[i].static_id]].area;
  const ivec3 p = frame_samples[i].point, d = -areas[own].direction;

  // Most rays meet no other area's box.
  bool any_box = false;
  const uint32_t area_count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = 0u; area < area_count && !any_box && !spent(); ++area)
    any_box = area != own && ray_may_meet(p, d, areas[area].box_low, areas[area].box_high);
  if (!any_box) return;

  uint32_t nearest = heights[i];   // crossings count below it
  uint32_t hit[kAreaWords];        // the areas crossed at `nearest`
  for (uint32_t w = 0u; w < kAreaWords; ++w) hit[w] = 0u;
  bool any = false;
  const uint32_t count = frame_lists[kListContactStatics].count;
  for (uint32_t box = 0u; box * kSlotBox < count && !spent(); ++box) {
    if (!ray_may_meet(p, d, slot_boxes[box].low, slot_boxes[box].high)) continue;
    const uint32_t end = min((box + 1u) * kSlotBox, count);
    for (uint32_t slot = box * kSlotBox; slot < end && !spent(); ++slot) {
      const uint32_t area = slots[slot].area;
      if (area == own) continue;
      const uvec3 corners = mockup_triangles[contact_statics[slot]];
      const ivec3 a = mockup_vertices[corners.x], b = mockup_vertices[corners.y], c = mockup_vertices[corners.z];
      if (!ray_may_meet(p, d, min(min(a, b), c), max(max(a, b), c))) continue;
      const Crossing crossing = ray_crossing(p, d, a, b, c);
      if (crossing.sign <= 0 || crossing.height > nearest || (!any && crossing.height == nearest)) continue;
      if (crossing.height < nearest) {
        for (uint32_t w = 0u; w < kAreaWords; ++w) hit[w] = 0u;
        budget += kAreaWords;
      }
      nearest = crossing.height;
      hit[area >> 5] |= 1u << (area & 31u);
      any = true;
    }
  }
  if (!any) return;
  for (uint32_t w = 0u; w < kAreaWords; ++w) {
    const uint32_t before = hit[w] == 0u ? 0u : atomicOr(areas[own].pierces[w], hit[w]);
    // Whoever sets a bit first appends it.
    for (uint32_t fresh = hit[w] & ~before; fresh != 0u; fresh &= fresh - 1u) {
      const uint32_t at = atomicAdd(frame_lists[kListPierces].count, 1u);
      if (at < frame_lists[kListPierces].capacity) pierces[at] = AreaPierce(own, 32u * w + uint32_t(findLSB(fresh)));
    }
  }
}
