// Which other areas' surfaces a sample's ray leaves first, before its height: docs/EXACTNESS.md section 7. The including shader declares
//   frame_lists[], frame_state, areas[] (writable), response, slot_boxes[], slots[], contact_statics[], the mock-up's triangles, pierces[].
#ifndef PALPATE_LIB_PIERCE
#define PALPATE_LIB_PIERCE
#include "shaders/lib/ray.glsl"
#include "shaders/lib/line_box.glsl"
#include "shaders/lib/budget.glsl"

const uint32_t kAreaWords = kMaxFrameAreas / 32u;

// The sample p of area `own` has the height H.
void find_pierced(uint32_t own, ivec3 p, uint32_t height) {
  const ivec3 d = -areas[own].direction;
  const vec3 e = ray_scaled(d);
  // Most rays meet no other area's box.
  bool any_box = false;
  const uint32_t area_count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = 0u; area < area_count && !any_box && !spent(1u); ++area)
    any_box = area != own && ray_may_meet_box(p, e, areas[area].box_low, areas[area].box_high);
  if (!any_box) return;

  uint32_t nearest = height;   // crossings count below it
  uint32_t hit[kAreaWords];    // the areas crossed at `nearest`
  for (uint32_t w = 0u; w < kAreaWords; ++w) hit[w] = 0u;
  bool any = false;
  const uint32_t count = frame_lists[kListContactStatics].count;
  for (uint32_t box = 0u; box * kSlotBox < count && !spent(1u); ++box) {
    if (!ray_may_meet_box(p, e, slot_boxes[box].low, slot_boxes[box].high)) continue;
    const uint32_t end = min((box + 1u) * kSlotBox, count);
    for (uint32_t slot = box * kSlotBox; slot < end && !spent(1u); ++slot) {
      const uint32_t area = slots[slot].area;
      if (area == own) continue;
      const uvec3 corners = mockup_triangles[contact_statics[slot]];
      const ivec3 a = mockup_vertices[corners.x], b = mockup_vertices[corners.y], c = mockup_vertices[corners.z];
      if (!ray_may_meet_triangle(p, e, a, b, c)) continue;
      const Crossing crossing = ray_crossing(p, d, a, b, c);
      if (crossing.sign <= 0 || crossing.height > nearest || (!any && crossing.height == nearest)) continue;
      if (crossing.height < nearest && !spent(kAreaWords))
        for (uint32_t w = 0u; w < kAreaWords; ++w) hit[w] = 0u;
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
#endif
