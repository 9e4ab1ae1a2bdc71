#version 460
// One invocation: a member of C_m. Lists its extra samples that weigh something, and the tiles of its sample grid.
// Reads C_m, the tool's triangles in its own frame, its extra samples. Writes tool_points, field_tiles.
// Before: the lists of samples and of C_m are closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindToolVertices, ivec3, tool_vertices);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolInfo, uint32_t, tool_info);
READ(kBindToolWeights, uint32_t, tool_weights);
READ(kBindToolExtras, ExtraSample, extras);
EDIT(kBindToolPoints, FieldPoint, tool_points);
EDIT(kBindFieldTiles, FieldTile, field_tiles);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/extra_samples.glsl"
#include "shaders/lib/sample_levels.glsl"

void list_extras(uint32_t mobile) {
  const uint32_t first = first_extra(mobile, scene.tool_extras), count = extras_from(first, mobile, scene.tool_extras);
  for (uint32_t i = 0u; i < count; ++i) {
    const uint32_t weight = uint32_t(extra_weight(extras[first + i].weights) >> 4);
    if (weight == 0u) continue;
    const uint32_t at = take_room(kListToolPoints, 1u);
    if (at < frame_lists[kListToolPoints].capacity) tool_points[at] = FieldPoint(world_from_tool(extras[first + i].point), mobile, weight);
  }
}

// Of the cells that reach into the triangle's box; they are decided one by one later.
void list_tiles(uint32_t mobile, uint32_t info) {
  const uvec3 corners = tool_triangles[mobile];
  const ivec3 a = tool_vertices[corners.x], b = tool_vertices[corners.y], c = tool_vertices[corners.z];
  const uint32_t axis = info >> kInfoAxisShift & 3u, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  const ivec3 low = min(min(a, b), c), high = max(max(a, b), c);
  const int32_t s = scene.tool_sample_spacing;
  const int32_t u_first = floor_div(low[u], s), v_first = floor_div(low[v], s);
  const uint32_t across = uint32_t(floor_div(high[u], s) - u_first) / uint32_t(kFieldTile) + 1u;
  const uint32_t down = uint32_t(floor_div(high[v], s) - v_first) / uint32_t(kFieldTile) + 1u;
  if (uint64_t(across) * uint64_t(down) >= uint64_t(kLoopBudget)) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t first = take_room(kListFieldTiles, across * down);
  const uint32_t capacity = frame_lists[kListFieldTiles].capacity;
  for (uint32_t t = 0u; t < across * down && first + t < capacity && !spent(1u); ++t)
    field_tiles[first + t] = FieldTile(mobile, u_first + kFieldTile * int32_t(t % across), v_first + kFieldTile * int32_t(t / across));
}

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListContactMobiles].count) return;
  const uint32_t mobile = contact_mobiles[i], info = tool_info[mobile];
  if ((info & kInfoHasExtra) != 0u) list_extras(mobile);
  if (tool_weights[mobile] != 0u) list_tiles(mobile, info);
}
