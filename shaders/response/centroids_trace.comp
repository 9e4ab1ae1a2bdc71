#version 460
// One invocation: a triangle of C_s. Traces −n_c from its rounded centroid through the tool triangles that
// its area has of C_m.
// Reads the mock-up's triangles, slot_areas, areas, the tool at its pose, mobile_state and mobile_areas. Adds
// the height to the area.
// Before: areas_associate, areas_direct.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindClusterBoxes, LatticeBox, cluster_boxes);
READ(kBindRunBoxes, LatticeBox, run_boxes);
READ(kBindToolCorners, ToolCorners, tool_corners);
READ(kBindToolRecords, ToolRecord, tool_records);
READ(kBindMobileState, uint32_t, mobile_state);
READ(kBindMobileAreas, uint32_t, mobile_areas);
READ(kBindSlotAreas, uint32_t, slot_areas);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/ray.glsl"
#include "shaders/lib/line_box.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/centroid.glsl"
#include "shaders/lib/area_sphere.glsl"

// Whether the area has the tool triangle at a place in the order of clusters: what areas_associate has put
// down, asked the other way round, so that no invocation walks a list of members.
bool area_has(uint32_t area, uint32_t place) {
  const uint32_t mobile = tool_records[place].id;
  if ((mobile_state[mobile] & kMobileSets) == 0u) return false;   // not in C_m
  const uint32_t nearest = mobile_areas[mobile];
  if (nearest != kNone) return nearest == area;
  const ToolCorners t = tool_corners[place];
  return area_holds(area, rounded_centroid(t.a, t.b, t.c));
}

// Triangles put by for the exact test (chosen: a ray of a compact tool has 2 to 6).
const uint32_t kCandidates = 16u;

// The smallest height at which the ray from p in direction d crosses a triangle of the area; kNone: none.
// First those that the ray may meet are put by, then all are tested: so that rays side by side, which meet
// different triangles, run the long exact test together.
uint32_t area_height(uint32_t area, ivec3 p, ivec3 d) {
  const vec3 e = ray_scaled(d);
  const uint32_t triangles = scene.tool.triangles;
  uint32_t candidates[kCandidates];
  uint32_t least = kNone;
  uint32_t i = 0u;   // place in the order of clusters
  while (i < triangles && !spent(1u)) {
    uint32_t count = 0u;
    while (i < triangles && count < kCandidates && !spent(1u)) {
      const uint32_t cluster = i / kClusterSize, run = i / kRunSize;
      if (i % kClusterSize == 0u &&
          !ray_may_meet_box(p, e, cluster_boxes[cluster].low, cluster_boxes[cluster].high)) {
        i += kClusterSize;
      } else if (i % kRunSize == 0u && !ray_may_meet_box(p, e, run_boxes[run].low, run_boxes[run].high)) {
        i += kRunSize;
      } else {
        const ToolCorners t = tool_corners[i];
        if (ray_may_meet_triangle(p, e, t.a, t.b, t.c) && area_has(area, i)) candidates[count++] = i;
        ++i;
      }
    }
    for (uint32_t k = 0u; k < count && !spent(1u); ++k) {
      const ToolCorners t = tool_corners[candidates[k]];
      // None for a void triangle: its corners are one point.
      const Crossing crossing = ray_crossing(p, d, t.a, t.b, t.c);
      if (crossing.sign != 0) least = min(least, crossing.height);
    }
  }
  return least;
}

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  const uint32_t area = slot_areas[slot];
  if (area == kNone) return;
  const ivec3 direction = areas[area].direction;
  if (direction == ivec3(0)) return;
  const uvec3 corners = mockup_triangles[contact_statics[slot]];
  const uint32_t height = area_height(
      area,
      rounded_centroid(mockup_vertices[corners.x], mockup_vertices[corners.y], mockup_vertices[corners.z]),
      -direction);
  tell_spent();
  if (height == kNone) return;
  atomicAdd(areas[area].rays, 1u);
  atomicMax(areas[area].max_height, height);
  atomicAdd(areas[area].height_sum, int64_t(height));
}
