#version 460
// One invocation: a slot of C_s, a member of C_m, and a sample inside the tool. Names their sets; in contact,
// empties what the slot carries, and lists the tiles of the member's sample grid and of both bodies' extra
// samples, and the sample if it weighs something.
// Reads C_s, C_m, samples, both bodies' triangles and extra samples. Writes the sets' results, carrier_work,
// mockup_points, field_tiles.
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
layout(constant_id = 1) const bool LISTED = true;     // preparation has listed the tool's samples

READ(kBindSamples, FrameSample, frame_samples);
WORDS(kBindMockupInfo, uint32_t, mockup_info)
WORDS(kBindMockupWeights, uint32_t, mockup_weights)
WORDS(kBindMockupLevels, uint32_t, mockup_levels)
READ(kBindMockupExtras, ExtraSample, mockup_extras);
TRIPLES(kBindToolVertices, ivec3, tool_vertices)
TRIPLES(kBindToolTriangles, uvec3, tool_triangles)
WORDS(kBindToolInfo, uint32_t, tool_info)
WORDS(kBindToolWeights, uint32_t, tool_weights)
READ(kBindToolExtras, ExtraSample, tool_extras);
WORDS(kBindToolLevels, uint32_t, tool_levels)
TEXELS(kBindToolSampleEnds, tool_sample_ends)
EDIT(kBindCarrierWork, int64_t, carrier_work);
EDIT(kBindMockupPoints, FieldPoint, mockup_points);
EDIT(kBindFieldTiles, FieldTile, field_tiles);

#include "shaders/lib/extra_samples.glsl"
#include "shaders/lib/sample_levels.glsl"
SAMPLE_WEIGHT(mockup_weight, mockup_levels, scene.mockup.triangles)
EXTRA_SAMPLES(mockup, mockup_extras)
EXTRA_SAMPLES(tool, tool_extras)
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindPlacedGroups, placed_groups)
GROUP_COUNTS(kBindPushedGroups, pushed_groups)

// Room for so many tiles: the first, and the first that there is no room for.
uvec2 take_tiles(uint32_t tiles) {
  const uint32_t first = take_room(kListFieldTiles, tiles),
                 end = min(first + tiles, frame_lists[kListFieldTiles].capacity);
  if (first < end) grow_placed_groups(0u, groups_to(end * kFieldTileLanes));
  return uvec2(first, end);
}

void list_extras(int32_t which, uint32_t entry, uvec2 extras) {
  if (extras.x == extras.y) return;
  const uvec2 tiles = take_tiles((extras.y - extras.x + kExtraTile - 1u) / kExtraTile);
  for (uint32_t t = tiles.x; t < tiles.y && !spent(1u); ++t) {
    const uint32_t begin = extras.x + (t - tiles.x) * kExtraTile;
    field_tiles[t] = FieldTile(entry, which, 0, 0u, begin, min(begin + kExtraTile, extras.y));
  }
}

// Of the cells that reach into the triangle's box; they are decided one by one later.
void list_tiles(uint32_t mobile, uint32_t entry, uint32_t info) {
  const uvec3 corners = tool_triangles(mobile);
  const ivec3 a = tool_vertices(corners.x), b = tool_vertices(corners.y), c = tool_vertices(corners.z);
  const uint32_t axis = info >> kInfoAxisShift & 3u, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  const ivec3 low = min(min(a, b), c), high = max(max(a, b), c);
  const int32_t s = scene.sample_spacing;
  const int32_t u_first = floor_div(low[u], s), v_first = floor_div(low[v], s);
  const uint32_t across = uint32_t(floor_div(high[u], s) - u_first) + 1u;
  const uint32_t down = uint32_t(floor_div(high[v], s) - v_first) + 1u;
  const uint64_t cells = uint64_t(across) * uint64_t(down);
  if (cells >= uint64_t(kLoopBudget) * uint64_t(kMostTiles)) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t tile = chunk_of(uint32_t(cells), FIELD_TILE, kMostTiles);
  const uvec2 tiles = take_tiles((uint32_t(cells) + tile - 1u) / tile);
  for (uint32_t t = tiles.x; t < tiles.y && !spent(1u); ++t) {
    const uint32_t begin = (t - tiles.x) * tile;
    field_tiles[t] =
        FieldTile(entry, u_first, v_first, across, begin, min(begin + tile, uint32_t(cells)));
  }
}

// Of those that are listed: the first ones weigh something, those of the frame's level.
void list_samples(uint32_t mobile, uint32_t entry) {
  const uvec4 begin = tool_sample_ends(kSampleEndTexels * mobile),
              more = tool_sample_ends(kSampleEndTexels * mobile + 1u);
  const uint32_t place = tool_levels(mobile), now = tool_level() >> 8,
                 level = place == 0u || now == 0u
                             ? 0u
                             : min(now, tool_levels(scene.tool.triangles + kSideLevelWords * (place - 1u)));
  const uint32_t count = level < 3u ? begin[1u + level] : more[level - 3u];
  if (count == 0u) return;
  const uint32_t tile = chunk_of(count, FIELD_TILE, kMostTiles);
  const uvec2 tiles = take_tiles((count + tile - 1u) / tile);
  for (uint32_t t = tiles.x; t < tiles.y && !spent(1u); ++t) {
    const uint32_t first = (t - tiles.x) * tile;
    field_tiles[t] = FieldTile(entry, kTileToolSamples, 0, 0u, begin.x + first, begin.x + min(first + tile, count));
  }
}

void take_static(uint32_t slot) {
  const uint32_t entry = contact_statics[slot], id = static_id(entry);
  take_pose(static_pose(entry));
  name_static(slot);
  if (!in_contact()) return;
  if (CARRIERS)
    for (uint32_t i = 0u; i < kCarrierWords; ++i) carrier_work[kCarrierWords * slot + i] = 0l;
  if (INSIDE && (mockup_info(id) & kInfoHasExtra) != 0u)
    list_extras(kTileMockupExtras, entry, mockup_extras_of(id, scene.mockup_extras));
}

void take_mobile(uint32_t place) {
  const uint32_t entry = contact_mobiles[place];
  take_pose(mobile_pose(entry));
  name_mobile(place);
  if (!in_contact()) return;
  const uint32_t mobile = mobile_id(entry), info = tool_info(mobile);
  if ((info & kInfoHasExtra) != 0u) list_extras(kTileToolExtras, entry, tool_extras_of(mobile, scene.tool_extras));
  if (tool_weights(mobile) == 0u) return;
  if (LISTED)
    list_samples(mobile, entry);
  else
    list_tiles(mobile, entry, info);
}

void take_sample(uint32_t i) {
  const FrameSample work = frame_samples[i];
  const uint32_t entry = work.static_id, id = static_id(entry);
  take_pose(static_pose(entry));
  if (!in_contact()) return;
  const uint32_t axis = mockup_info(id) >> kInfoAxisShift & 3u;
  const ivec2 ij =
      cell_of_sample(ivec2(work.point[(axis + 1u) % 3u], work.point[(axis + 2u) % 3u]), scene.sample_spacing);
  const uint32_t weight =
      uint32_t(mockup_weight(id, mockup_weights(id), level_of_cell(ij), mockup_level()) >> 6);
  if (weight == 0u) return;
  const uint32_t at = take_room(kListMockupPoints, 1u);
  if (at >= frame_lists[kListMockupPoints].capacity) return;
  mockup_points[at] = FieldPoint(work.point, entry, weight);
  if (begins_group(at, 1u)) grow_pushed_groups_deep(kGroupsMockupPush, groups_to(at + 1u), LANES);
}

void main() {
  const uint32_t i = flat_invocation();
  if (i < list_count(kListContactStatics)) take_static(i);
  if (i < list_count(kListContactMobiles)) take_mobile(i);
  if (INSIDE && i < list_count(kListSamples)) take_sample(i);
  tell_spent();
}
