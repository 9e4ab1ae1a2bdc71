// The height of a ray through the transformed tool, docs/EXACTNESS.md section 7. The including shader declares
//   cluster_boxes[], run_boxes[], tool_corners[], scene, frame_state (writable), and what lib/tool_walk.glsl asks for.
#ifndef PALPATE_LIB_TOOL_RAY
#define PALPATE_LIB_TOOL_RAY
#include "shaders/lib/ray.glsl"
#include "shaders/lib/line_box.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/direction.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"

layout(constant_id = 2) const bool WALK = false;   // rays walk through the tool's fine partition; else they look at the whole tool

const uint32_t kLevels = 8u;   // distinct heights kept a sweep; more take another sweep (chosen: most rays have fewer)

// m: the normal of the triangle at a place in the order of clusters, as a direction.
ivec3 tool_normal(uint32_t place) {
  if (WALK) {
    const RecordCorners r = record_at(place);
    return normalise(raw_normal(world_from_tool(r.a), world_from_tool(r.b), world_from_tool(r.c)));
  }
  const ToolCorners t = tool_corners[place];
  return normalise(raw_normal(t.a, t.b, t.c));
}

// Whether the first of two triangles has the smaller normal in the order of components.
bool normal_before(uint32_t first, uint32_t second) {
  const ivec3 a = tool_normal(first), b = tool_normal(second);
  return a.x != b.x ? a.x < b.x : (a.y != b.y ? a.y < b.y : a.z < b.z);
}

// The lowest crossing heights of one sweep, ascending, equal ones merged. Where all places are taken there may be more above the last.
struct Levels {
  uint32_t count;
  uint32_t height[kLevels];
  int32_t sign_sum[kLevels];
  uint32_t triangle[kLevels];  // of those that meet there, the one with the smallest normal
};

void levels_insert(inout Levels levels, uint32_t height, int32_t sign_of_crossing, uint32_t triangle) {
  uint32_t at = 0u;
  while (at < levels.count && levels.height[at] < height) ++at;
  if (at < levels.count && levels.height[at] == height) {
    levels.sign_sum[at] += sign_of_crossing;
    if (normal_before(triangle, levels.triangle[at])) levels.triangle[at] = triangle;
    return;
  }
  if (at == kLevels) return;
  const uint32_t last = min(levels.count, kLevels - 1u);
  for (uint32_t i = last; i > at; --i) {
    levels.height[i] = levels.height[i - 1u];
    levels.sign_sum[i] = levels.sign_sum[i - 1u];
    levels.triangle[i] = levels.triangle[i - 1u];
  }
  levels.height[at] = height;
  levels.sign_sum[at] = sign_of_crossing;
  levels.triangle[at] = triangle;
  levels.count = last + 1u;
}

const uint32_t kCandidates = 16u;   // triangles put by for the exact test (chosen: a ray of a compact tool has 2 to 6)

// The lowest crossings of the ray with heights of at least `from`; `total` is the sum of the signs of all.
// First the triangles that the ray may meet are put by, then all are tested: so that rays side by side, which meet different
// triangles, run the long exact test together.
Levels tool_sweep(ivec3 p, ivec3 d, uint32_t from, out int32_t total) {
  Levels levels;
  levels.count = 0u;
  total = 0;
  const vec3 e = ray_scaled(d);
  const uint32_t triangles = scene.tool.triangles;
  uint32_t candidates[kCandidates];
  uint32_t i = 0u;   // place in the order of clusters
  while (i < triangles && !spent(1u)) {
    uint32_t count = 0u;
    while (i < triangles && count < kCandidates && !spent(1u)) {
      const uint32_t cluster = i / kClusterSize, run = i / kRunSize;
      if (i % kClusterSize == 0u && !ray_may_meet_box(p, e, cluster_boxes[cluster].low, cluster_boxes[cluster].high)) {
        i += kClusterSize;
      } else if (i % kRunSize == 0u && !ray_may_meet_box(p, e, run_boxes[run].low, run_boxes[run].high)) {
        i += kRunSize;
      } else {
        const ToolCorners t = tool_corners[i];
        if (ray_may_meet_triangle(p, e, t.a, t.b, t.c)) candidates[count++] = i;
        ++i;
      }
    }
    for (uint32_t k = 0u; k < count && !spent(1u); ++k) {
      const ToolCorners t = tool_corners[candidates[k]];
      const Crossing crossing = ray_crossing(p, d, t.a, t.b, t.c);   // none for a void triangle: its corners are one point
      if (crossing.sign == 0) continue;
      total += crossing.sign;
      if (crossing.height < from || spent(2u * kLevels)) continue;
      levels_insert(levels, crossing.height, crossing.sign, candidates[k]);
    }
  }
  return levels;
}

#include "shaders/lib/tool_walk.glsl"

#ifdef TOOL_RAY_LISTS
// The lowest crossings of a ray that the host has listed, as tool_sweep; `item` is the sample's number. The including shader declares ray_lists[]
// and ray_places[].
Levels tool_listed(uint32_t item, ivec3 p, ivec3 d, uint32_t from, out int32_t total) {
  Levels levels;
  levels.count = 0u;
  total = 0;
  const RayList list = ray_lists[item];
  for (uint32_t k = list.begin; k < list.end && !spent(1u); ++k) {
    const uint32_t place = ray_places[k];
    const RecordCorners r = record_at(place);
    const Crossing crossing = ray_crossing(p, d, world_from_tool(r.a), world_from_tool(r.b), world_from_tool(r.c));
    if (crossing.sign == 0 || crossing.height >= list.stop) continue;
    total += crossing.sign;
    if (crossing.height < from || spent(2u * kLevels)) continue;
    levels_insert(levels, crossing.height, crossing.sign, place);
  }
  return levels;
}
layout(constant_id = 3) const bool LISTED = false;   // rays have lists
uint32_t listed_item = 0u;                           // whose
#endif

// The height of the sample p over the tool: `nearest`: the smallest crossing height; else the smallest one above which the
// signs add up to 0. kNone: no crossing. `triangle`: of those that are crossed there, the one with the smallest normal.
uint32_t tool_height(ivec3 p, ivec3 d, bool nearest, out uint32_t triangle) {
  triangle = 0u;
  uint32_t from = 0u;
  int32_t passed = 0;   // sum of the signs below `from`
  do {
    int32_t total;
    Levels levels;
#ifdef TOOL_RAY_LISTS
    if (LISTED) levels = tool_listed(listed_item, p, d, from, total);
    else
#endif
    if (WALK) levels = tool_walk(p, d, from, total);
    else levels = tool_sweep(p, d, from, total);
    if (levels.count == 0u) return kNone;
    triangle = levels.triangle[0];
    if (nearest) return levels.height[0];
    for (uint32_t i = 0u; i < levels.count; ++i) {
      passed += levels.sign_sum[i];
      triangle = levels.triangle[i];
      if (passed == total) return levels.height[i];
    }
    if (levels.count < kLevels) return kNone;   // only when the budget is spent: above the last crossing nothing is left
    from = levels.height[kLevels - 1u] + 1u;
  } while (!spent(1u));
  return kNone;
}
#endif
