#version 460
// kFieldTileLanes invocations: a tile of a tool triangle's samples, listed or a cell of its grid each at a
// time, or of extra samples.
// Lists the samples that weigh something; of the tool's grid those that lie in a V_bnd or V_int voxel of the
// mock-up, or of a closed one with their triangle's first corner where it touches nothing.
// Reads field_tiles, both bodies' extra samples, the tool in its own frame, the mock-up's partition. Writes
// tool_points, mockup_points.
// Before: field_members; its list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"
#include "shaders/lib/voxel_range.glsl"
#include "shaders/lib/sample.glsl"

layout(constant_id = 0) const bool CLOSED = true;   // the mock-up
layout(constant_id = 1) const bool LISTED = true;   // preparation has listed the tool's samples

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindFieldTiles, FieldTile, field_tiles);
TRIPLES(kBindToolVertices, ivec3, tool_vertices)
TRIPLES(kBindToolTriangles, uvec3, tool_triangles)
WORDS(kBindToolInfo, uint32_t, tool_info)
WORDS(kBindToolWeights, uint32_t, tool_weights)
WORDS(kBindToolLevels, uint32_t, tool_levels)
TEXELS(kBindToolSamplePoints, tool_sample_points)
READ(kBindMobileState, uint32_t, mobile_state);
WORDS(kBindMockupBrickSlot, uint32_t, mockup_brick_slots)
WORDS(kBindMockupBricks, uint32_t, mockup_bricks)
READ(kBindMockupExtras, ExtraSample, mockup_extras);
READ(kBindToolExtras, ExtraSample, tool_extras);
EDIT(kBindToolPoints, FieldPoint, tool_points);
EDIT(kBindMockupPoints, FieldPoint, mockup_points);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/group_count.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(mobile, kBindMobileKeys)
POSED_TABLE(static, kBindStaticKeys)
GROUP_COUNTS(kBindPushedGroups, pushed_groups)
#include "shaders/lib/pose.glsl"
#define PARTITION(name) mockup_##name
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slots
#define PARTITION_BRICKS mockup_bricks
#include "shaders/lib/partition.glsl"
#include "shaders/lib/sample_levels.glsl"
SAMPLE_WEIGHT(tool_weight, tool_levels, scene.tool.triangles)

void list_tool_point(FieldPoint point) {
  const uint32_t at = take_room(kListToolPoints, 1u);
  if (at >= frame_lists[kListToolPoints].capacity) return;
  tool_points[at] = point;
  if (begins_group(at, 1u)) grow_pushed_groups_deep(kGroupsToolPush, groups_to(at + 1u), LANES);
}

void take_tool_extra(FieldTile tile, uint32_t i, uint32_t level) {
  const uint32_t weight = uint32_t(extra_weight(tool_extras[i].weights, level) >> 6);
  if (weight != 0u) list_tool_point(FieldPoint(world_from_tool(tool_extras[i].point), tile.triangle, weight));
}

void take_mockup_extra(FieldTile tile, uint32_t i, uint32_t level) {
  const uint32_t weight = uint32_t(extra_weight(mockup_extras[i].weights, level) >> 6);
  if (weight == 0u) return;
  const uint32_t at = take_room(kListMockupPoints, 1u);
  if (at >= frame_lists[kListMockupPoints].capacity) return;
  mockup_points[at] = FieldPoint(mockup_extras[i].point, tile.triangle | kExtraPoint, weight);
  if (begins_group(at, 1u)) grow_pushed_groups_deep(kGroupsMockupPush, groups_to(at + 1u), LANES);
}

void take_listed(FieldTile tile) {
  const uint32_t mobile = mobile_id(tile.triangle);
  take_pose(mobile_pose(tile.triangle));
  const uint32_t base = tool_weights(mobile), level = tool_level();
  const bool own = !CLOSED || (mobile_state[tile.triangle] & kMobileHit) != 0u;
  const ivec3 corner = world_from_tool(tool_vertices(tool_triangles(mobile).x));
  for (uint32_t i = tile.begin + flat_invocation() % kFieldTileLanes; i < tile.end; i += kFieldTileLanes) {
    const uvec4 listed = tool_sample_points(i);
    const uint32_t weight = uint32_t(tool_weight(mobile, base, listed.w, level) >> 6);
    const ivec3 p = world_from_tool(ivec3(listed.xyz));
    if (weight != 0u && mockup_class_of(mockup_voxel_of(own ? p : corner)) != kVoxelExternal)
      list_tool_point(FieldPoint(p, tile.triangle, weight));
  }
}

void take_grid(FieldTile tile) {
  const uint32_t mobile = mobile_id(tile.triangle);
  take_pose(mobile_pose(tile.triangle));
  const uvec3 corners = tool_triangles(mobile);
  const ivec3 a = tool_vertices(corners.x), b = tool_vertices(corners.y), c = tool_vertices(corners.z);
  const int32_t axis = int32_t(tool_info(mobile) >> kInfoAxisShift & 3u), spacing = scene.sample_spacing;
  const SampledTriangle triangle = SampledTriangle(a, b, c, axis, raw_normal(a, b, c));
  const uint32_t base = tool_weights(mobile), level = tool_level();
  const bool own = !CLOSED || (mobile_state[tile.triangle] & kMobileHit) != 0u;
  const ivec3 corner = world_from_tool(a);
  for (uint32_t cell = tile.begin + flat_invocation() % kFieldTileLanes; cell < tile.end;
       cell += kFieldTileLanes) {
    const ivec2 ij = ivec2(tile.first_u, tile.first_v) + ivec2(cell % tile.across, cell / tile.across),
                g = sample_of_cell(ij, spacing);
    if (!grid_point_inside(triangle, g)) continue;
    const uint32_t weight = uint32_t(tool_weight(mobile, base, level_of_cell(ij), level) >> 6);
    if (weight == 0u) continue;
    const ivec3 p = world_from_tool(sample_point(triangle, g));
    if (mockup_class_of(mockup_voxel_of(own ? p : corner)) == kVoxelExternal) continue;
    list_tool_point(FieldPoint(p, tile.triangle, weight));
  }
}

void take_extras(FieldTile tile) {
  const bool of_mockup = tile.first_u == kTileMockupExtras;
  take_pose(of_mockup ? static_pose(tile.triangle) : mobile_pose(tile.triangle));
  const uint32_t level = of_mockup ? mockup_level() : tool_level();
  for (uint32_t i = tile.begin + flat_invocation() % kFieldTileLanes; i < tile.end; i += kFieldTileLanes)
    if (of_mockup)
      take_mockup_extra(tile, i, level);
    else
      take_tool_extra(tile, i, level);
}

void main() {
  const uint32_t item = flat_invocation() / kFieldTileLanes;
  if (item >= list_count(kListFieldTiles)) return;
  const FieldTile tile = field_tiles[item];
  if (LISTED && tile.first_u == kTileToolSamples)
    take_listed(tile);
  else if (!LISTED && tile.across != 0u)
    take_grid(tile);
  else
    take_extras(tile);
}
