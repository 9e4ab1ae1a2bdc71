#version 460
// One invocation: a slot of C_s and a member of C_m. Names their sets; in contact, empties what the slot
// carries, and lists extra samples that weigh something and the tiles of the member's sample grid.
// Reads C_s and C_m, both bodies' extra samples, the tool's triangles in its own frame. Writes the sets'
// results, carrier_work, mockup_points, tool_points, field_tiles.
// Before: the lists of samples, C_s and C_m are closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"
CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
#include "shaders/lib/set_name.glsl"

layout(constant_id = 0) const bool INSIDE = true;     // the tool has an inside

READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupExtras, ExtraSample, mockup_extras);
READ(kBindToolVertices, ivec3, tool_vertices);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolInfo, uint32_t, tool_info);
READ(kBindToolWeights, uint32_t, tool_weights);
READ(kBindToolExtras, ExtraSample, tool_extras);
EDIT(kBindCarrierWork, int64_t, carrier_work);
EDIT(kBindMockupPoints, FieldPoint, mockup_points);
EDIT(kBindToolPoints, FieldPoint, tool_points);
EDIT(kBindFieldTiles, FieldTile, field_tiles);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/extra_samples.glsl"
#include "shaders/lib/sample_levels.glsl"
EXTRA_SAMPLES(mockup, mockup_extras)
EXTRA_SAMPLES(tool, tool_extras)
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindPlacedGroups, placed_groups)
GROUP_COUNTS(kBindPushedGroups, pushed_groups)

void list_static_extras(uint32_t id, uint32_t entry) {
  const uint32_t first = first_mockup_extra(id, scene.mockup_extras),
                 count = mockup_extras_from(first, id, scene.mockup_extras);
  for (uint32_t i = 0u; i < count; ++i) {
    const uint32_t weight = uint32_t(extra_weight(mockup_extras[first + i].weights) >> 6);
    if (weight == 0u) continue;
    const uint32_t at = take_room(kListMockupPoints, 1u);
    if (at >= frame_lists[kListMockupPoints].capacity) continue;
    mockup_points[at] = FieldPoint(mockup_extras[first + i].point, entry, weight);
    if (begins_group(at, 1u))
      grow_placed_groups_deep(kGroupsMockupPush,
                              groups_to(list_count(kListSamples)) + groups_to(at + 1u),  // behind the samples
                              LANES);
  }
}

void list_mobile_extras(uint32_t mobile, uint32_t entry) {
  const uint32_t first = first_tool_extra(mobile, scene.tool_extras),
                 count = tool_extras_from(first, mobile, scene.tool_extras);
  for (uint32_t i = 0u; i < count; ++i) {
    const uint32_t weight = uint32_t(extra_weight(tool_extras[first + i].weights) >> 6);
    if (weight == 0u) continue;
    const uint32_t at = take_room(kListToolPoints, 1u);
    if (at >= frame_lists[kListToolPoints].capacity) continue;
    tool_points[at] = FieldPoint(world_from_tool(tool_extras[first + i].point), entry, weight);
    if (begins_group(at, 1u)) grow_pushed_groups_deep(0u, groups_to(at + 1u), LANES);
  }
}

// Of the cells that reach into the triangle's box; they are decided one by one later.
void list_tiles(uint32_t mobile, uint32_t entry, uint32_t info) {
  const uvec3 corners = tool_triangles[mobile];
  const ivec3 a = tool_vertices[corners.x], b = tool_vertices[corners.y], c = tool_vertices[corners.z];
  const uint32_t axis = info >> kInfoAxisShift & 3u, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  const ivec3 low = min(min(a, b), c), high = max(max(a, b), c);
  const int32_t s = scene.sample_spacing;
  const int32_t u_first = floor_div(low[u], s), v_first = floor_div(low[v], s);
  const uint32_t across = uint32_t(floor_div(high[u], s) - u_first) + 1u;
  const uint32_t down = uint32_t(floor_div(high[v], s) - v_first) + 1u;
  const uint64_t cells = uint64_t(across) * uint64_t(down);
  if (cells >= uint64_t(kLoopBudget) * uint64_t(kFieldTile)) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t tiles = (uint32_t(cells) + kFieldTile - 1u) / kFieldTile;
  const uint32_t first = take_room(kListFieldTiles, tiles), capacity = frame_lists[kListFieldTiles].capacity;
  if (first < capacity)
    grow_placed_groups(kGroupsTiles, groups_to(min(first + tiles, capacity) * kFieldTileLanes));
  for (uint32_t t = 0u; t < tiles && first + t < capacity && !spent(1u); ++t)
    field_tiles[first + t] = FieldTile(entry, u_first, v_first, across, t * kFieldTile,
                                       min((t + 1u) * kFieldTile, uint32_t(cells)));
}

void take_static(uint32_t slot) {
  const uint32_t entry = contact_statics[slot], id = static_id(entry);
  take_pose(static_pose(entry));
  name_static(slot);
  if (!in_contact()) return;
  if (CARRIERS)
    for (uint32_t i = 0u; i < kCarrierWords; ++i) carrier_work[kCarrierWords * slot + i] = 0l;
  if (INSIDE && (mockup_info[id] & kInfoHasExtra) != 0u) list_static_extras(id, entry);
}

void take_mobile(uint32_t place) {
  const uint32_t entry = contact_mobiles[place];
  take_pose(mobile_pose(entry));
  name_mobile(place);
  if (!in_contact()) return;
  const uint32_t mobile = mobile_id(entry), info = tool_info[mobile];
  if ((info & kInfoHasExtra) != 0u) list_mobile_extras(mobile, entry);
  if (tool_weights[mobile] != 0u) list_tiles(mobile, entry, info);
}

void main() {
  const uint32_t i = flat_invocation();
  if (i < list_count(kListContactStatics)) take_static(i);
  if (i < list_count(kListContactMobiles)) take_mobile(i);
}
