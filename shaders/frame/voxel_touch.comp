#version 460
#extension GL_GOOGLE_include_directive : require
// Which voxels the triangles of near runs touch, exactly: IMT and BMT. A workgroup kRunsAGroup NearRuns, an
// invocation a triangle. Each goes through the voxels of its box that are not V_ext and that its plane may
// cross, in rounds; what a round has found is shared out and asked. Reads tool_records and the mock-up's
// partition; sets kMobileInternal or kMobileBoundary; a touched V_bnd voxel enters touched_voxels once, and
// its list goes to pair_chunks for each triangle that touches it.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindOccupied, uint32_t, occupied);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindNearRuns, NearRun, near_runs);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindTouchedVoxels, uvec4, touched_voxels);
EDIT(kBindPairChunks, PairChunk, pair_chunks);

#include "shaders/lib/budget.glsl"
#include "shaders/lib/turned_box.glsl"
#include "shaders/lib/occupied.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"
GROUP_COUNTS(kBindListedGroups, listed_groups)
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slot
#define PARTITION_BRICKS mockup_bricks
#define PARTITION(name) mockup_##name
#include "shaders/lib/partition.glsl"

const uint32_t kRoom = 1024u;   // voxels of a round (chosen: 8 KiB); a row of eight always fits
const uint32_t kStepCost = 5u;   // a row adds up to eight iterations of its own
const uint32_t kWholeBrick = 1u << 24, kNothing = 1u << 25;

// A voxel and the triangle that may touch it: x + 2^16 · y, z + 2^16 · invocation. With kWholeBrick: all of a
// brick of V_int, by its first voxel.
shared uvec2 found[kRoom];
shared uint32_t found_count, unfinished;
shared int32_t corners[9u * kGroupSize];   // of the invocations' triangles
shared uint32_t places[kGroupSize];

ivec3 corner_of(uint32_t lane, uint32_t k) {
  return ivec3(corners[9u * lane + 3u * k], corners[9u * lane + 3u * k + 1u], corners[9u * lane + 3u * k + 2u]);
}
void put_corner(uint32_t lane, uint32_t k, ivec3 p) {
  for (uint32_t i = 0u; i < 3u; ++i) corners[9u * lane + 3u * k + i] = p[i];
}

// The way of an invocation through the bricks of its triangle's box, row by row.
ivec3 first, last;          // voxels of the box
ivec3 low_brick, high_brick, brick;
bool more = false;          // there is one, brick
uint32_t slot;              // of the present mixed brick
ivec3 row_low, row_high;    // of its voxels those in the box
ivec2 row;                  // y, z of the next row
bool in_brick = false;      // there is one
ivec3 origin;               // a corner
vec3 facing;                // its raw normal, of size 1 by the sum of its components' sizes

// Whether a box of this side lies on one side of the plane. facing is off by less than 2^-21; differences,
// products and sums are rounded: less than 2^-18 of the largest difference in all.
bool off_plane(ivec3 low, int32_t side) {
  const vec3 d = vec3(low - origin), middle = d + 0.5 * float(side);
  const vec3 parts = facing * middle;
  const float size = max(max(abs(d.x), abs(d.y)), abs(d.z)) + float(side);
  return abs(parts.x + parts.y + parts.z) > 0.5 * float(side) + size * (1.0 / 262144.0) + 1.0;
}

void begin(uint32_t lane, uint32_t item) {
  if (item >= list_count(kListNearRuns)) return;
  const NearRun part = near_runs[item];
  const uint32_t place = part.run * kRunSize + lane % kRunSize;
  if (place >= scene.tool.triangles || (uint32_t(tool_records[6u * place + 3u] >> 32) & kInfoCollapsed) != 0u)
    return;
  const RecordCorners r = record_at(place);
  const ivec3 a = world_from_tool(r.a), b = world_from_tool(r.b), c = world_from_tool(r.c);
  const i64vec3 normal = raw_normal(a, b, c);
  if (normal == i64vec3(0l)) return;   // collinear at this pose
  places[lane] = place;
  put_corner(lane, 0u, a);
  put_corner(lane, 1u, b);
  put_corner(lane, 2u, c);
  origin = a;
  const vec3 n = vec3(normal);
  facing = n / (abs(n.x) + abs(n.y) + abs(n.z));
  if (!voxels_of(min(min(a, b), c), max(max(a, b), c), first, last) || !may_be_occupied(first, last)) return;
  const uvec3 range = uvec3(part.x, part.y, part.z);
  low_brick = max(first >> 3, ivec3(range & 0xFFFFu));
  high_brick = min(last >> 3, ivec3(range >> 16));
  brick = low_brick;
  more = all(lessThanEqual(low_brick, high_brick));
}

// Reserves n places, n ≤ 8, for what the present brick or row has. False: there is no room in this round.
bool take_places(uint32_t n, out uint32_t at) {
  at = atomicAdd(found_count, n);
  if (at + n <= kRoom) return true;
  for (uint32_t i = at; i < kRoom; ++i) found[i] = uvec2(0u, kNothing);
  return false;
}

// The next brick. False: no room.
bool enter_brick(uint32_t lane) {
  const int32_t side = 8 * scene.mockup.grid.size;
  const ivec3 low = scene.mockup.grid.origin + side * brick;
  slot = mockup_slot_of(brick);
  if (slot != kBrickExternal && !off_plane(low, side)) {
    if (slot == kBrickInternal) {
      uint32_t at;
      if (!take_places(1u, at)) return false;
      const uvec3 v = uvec3(8 * brick);
      found[at] = uvec2(v.x | v.y << 16, v.z | lane << 16 | kWholeBrick);
    } else {
      row_low = max(first - 8 * brick, ivec3(0));
      row_high = min(last - 8 * brick, ivec3(7));
      row = row_low.yz;
      in_brick = true;
    }
  }
  const bool end_x = brick.x == high_brick.x, end_y = end_x && brick.y == high_brick.y;
  more = !end_y || brick.z != high_brick.z;
  return true;
}

// Of eight voxels from `voxel` on along x, those in whose way the plane lies, a bit each: as off_plane().
uint32_t on_plane(ivec3 voxel) {
  const int32_t size = scene.mockup.grid.size;
  const vec3 d = vec3(scene.mockup.grid.origin + size * voxel - origin), parts = facing * (d + 0.5 * float(size));
  const float most = max(max(abs(d.x), abs(d.y)), abs(d.z)) + 8.0 * float(size),
              reach = 0.5 * float(size) + most * (1.0 / 262144.0) + 1.0;
  const float at = parts.x + parts.y + parts.z, along = facing.x * float(size);
  uint32_t bits = 0u;
  for (int x = 0; x < 8; ++x) bits |= uint32_t(abs(at + along * float(x)) <= reach) << x;
  return bits;
}

// The next row of the present brick. False: no room.
bool take_row(uint32_t lane) {
  const uint32_t word = uint32_t(row.x >> 2 | row.y << 1), shift = uint32_t(row.x & 3) * 8u;
  const uint32_t along_x = (2u << row_high.x) - (1u << row_low.x);
  const ivec3 voxel = ivec3(8 * brick.x, 8 * brick.yz + row);
  uint32_t bits = (mockup_bricks[slot].boundary[word] | mockup_bricks[slot].internal_[word]) >> shift & along_x &
                  on_plane(voxel);
  uint32_t at;
  if (bits != 0u && !take_places(uint32_t(bitCount(bits)), at)) return false;
  for (; bits != 0u; bits &= bits - 1u)
    found[at++] = uvec2(uint32_t(voxel.x + findLSB(bits)) | uint32_t(voxel.y) << 16,
                        uint32_t(voxel.z) | lane << 16);
  row.x += 1;
  if (row.x > row_high.y) row = ivec2(row_low.y, row.y + 1);
  in_brick = row.y <= row_high.z;
  return true;
}

void next_brick() {
  if (brick.x < high_brick.x) {
    brick.x += 1;
    return;
  }
  brick.x = low_brick.x;
  if (brick.y < high_brick.y) {
    brick.y += 1;
    return;
  }
  brick.y = low_brick.y;
  brick.z += 1;
}

void mark_voxel(uint32_t place, uint32_t boundary, uvec3 voxel) {
  const bool is_new = (atomicOr(voxel_state[boundary], kVoxelTouched) & kVoxelTouched) == 0u;
  if (is_new) {
    const uint32_t at = take_room(kListTouchedVoxels, 1u);
    if (at < frame_lists[kListTouchedVoxels].capacity) {
      touched_voxels[at] = uvec4(boundary, voxel);
      if (begins_group(at, 1u)) grow_result_groups(0u, groups_to(at + 1u));
    }
  }
  const uint32_t list_begin = mockup_list_begin[boundary], list_end = mockup_list_begin[boundary + 1u];
  const uint32_t chunk = chunk_of(list_end - list_begin, kPairChunk, kMostChunks),
                 chunks = (list_end - list_begin + chunk - 1u) / chunk;
  if (chunks == 0u) return;
  const uint32_t at = take_room(kListPairChunks, chunks), capacity = frame_lists[kListPairChunks].capacity;
  if (at < capacity && begins_group(at, chunks))
    grow_listed_groups(kGroupsPairs, groups_to(min(at + chunks, capacity)));
  for (uint32_t i = 0u; i < chunks && at + i < capacity && !spent(1u); ++i)
    pair_chunks[at + i] =
        PairChunk(place | (is_new ? kFirstTouch : 0u), list_begin + i * chunk,
                  min(list_begin + (i + 1u) * chunk, list_end), voxel.x | voxel.y << 16, voxel.z, 0u);
}

void decide(uvec2 work) {
  if ((work.y & kNothing) != 0u) return;
  const uint32_t lane = work.y >> 16 & (kGroupSize - 1u), place = places[lane];
  const bool whole = (work.y & kWholeBrick) != 0u;
  const ivec3 a = corner_of(lane, 0u), b = corner_of(lane, 1u), c = corner_of(lane, 2u);
  const uvec3 voxel = uvec3(work.x & 0xFFFFu, work.x >> 16, work.y & 0xFFFFu);
  const int32_t size = scene.mockup.grid.size;
  const ivec3 low = scene.mockup.grid.origin + size * ivec3(voxel);
  if (!triangle_touches_box(a, b, c, raw_normal(a, b, c), low, low + (whole ? 8 * size : size))) return;
  const uint32_t boundary = whole ? kNoVoxel : mockup_boundary_index(ivec3(voxel));
  const bool internal = INTERNAL && boundary == kNoVoxel;
  mark_mobile(uint32_t(tool_records[6u * place + 1u] >> 32), internal ? kMobileInternal : kMobileBoundary);
  if (!internal) mark_voxel(place, boundary, voxel);
}

void main() {
  const uint32_t lane = gl_LocalInvocationIndex;
  begin(lane, flat_group() * kRunsAGroup + lane / kRunSize);
  bool again = true;
  while (again) {
    if (lane == 0u) found_count = unfinished = 0u;
    barrier();
    while ((in_brick || more) && !spent(kStepCost)) {
      if (!(in_brick ? take_row(lane) : enter_brick(lane))) break;
      if (!in_brick) next_brick();
    }
    if ((in_brick || more) && loop_budget < kLoopBudget) unfinished = 1u;
    barrier();
    const uint32_t count = min(found_count, kRoom);
    again = unfinished != 0u;
    for (uint32_t i = lane; i < count && !spent(1u); i += kGroupSize) decide(found[i]);
    barrier();
  }
}
