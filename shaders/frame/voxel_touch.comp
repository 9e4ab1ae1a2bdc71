#version 460
#extension GL_GOOGLE_include_directive : require
// Which voxels the triangles of near runs touch, exactly: IMT and BMT. A workgroup RUNS_A_GROUP NearRuns, an
// invocation a triangle. Each goes through its box for voxels that are not V_ext and that its plane may
// cross, in rounds; what a round has found is shared out and asked. Reads tool_records and the mock-up's
// partition; sets kMobileInternal or kMobileBoundary; a touched V_bnd voxel enters touched_voxels once, and
// its list goes to pair_chunks for each triangle that touches it.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindOccupied, uint32_t, occupied);
WORDS(kBindMockupBrickSlot, uint32_t, mockup_brick_slot)
WORDS(kBindMockupBricks, uint32_t, mockup_bricks)
WORDS(kBindMockupListBegin, uint32_t, mockup_list_begin)
TEXELS(kBindToolRecords, tool_records)
READ(kBindNearRuns, NearRun, near_runs);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindTouchedVoxels, uvec4, touched_voxels);
EDIT(kBindPairChunks, PairChunk, pair_chunks);

#include "shaders/lib/plan.glsl"
#include "shaders/lib/batch/group_poses.glsl"
#include "shaders/lib/broad_phase/turned_box.glsl"
#include "shaders/lib/broad_phase/occupied.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"
POSED_TABLE(voxel, kBindVoxelKeys)
GROUP_COUNTS(kBindListedGroups, listed_groups)
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slot
#define PARTITION_BRICKS mockup_bricks
#define PARTITION(name) mockup_##name
#include "shaders/lib/partition.glsl"

const uint32_t kRoom = 1024u;   // voxels of a round (chosen: 8 KiB); a word of 32 always fits
const uint32_t kStepCost = 16u;   // a step adds up to 32 iterations of its own

// A voxel and the triangle that may touch it: x + 2^16 · y + 2^32 · z + 2^48 · invocation. With kWholeBrick:
// all of a brick of V_int, by its first voxel.
const uint64_t kWholeBrick = 1ul << 56, kNothing = 1ul << 57;
shared uint64_t found[kRoom];
shared uint32_t found_count, unfinished;
shared int32_t corners[9u * kGroupSize];   // of the invocations' triangles
shared uint32_t places[kGroupSize];

ivec3 corner_of(uint32_t lane, uint32_t k) {
  const uint32_t at = 9u * lane + 3u * k;
  return ivec3(corners[at], corners[at + 1u], corners[at + 2u]);
}
void put_corner(uint32_t lane, uint32_t k, ivec3 p) {
  for (uint32_t i = 0u; i < 3u; ++i) corners[9u * lane + 3u * k + i] = p[i];
}

// The way of an invocation through its triangle's box, brick by brick and in those word by word: eight voxels
// along x, four along y.
ivec3 first, last;   // voxels of the box
ivec3 low_brick, high_brick, brick;
bool more = false;   // there is one, brick
int32_t z = -1, half_y;   // of the present word; −1: the brick's first
ivec3 origin;        // a corner
vec3 facing;         // its raw normal, of size 1 by the sum of its components' sizes

// Whether a box of this side lies on one side of the plane. facing is off by less than 2^-21; differences,
// products and sums are rounded: less than 2^-18 of the largest difference in all.
bool off_plane(ivec3 low, int32_t side) {
  const vec3 d = vec3(low - origin), middle = d + 0.5 * float(side);
  const vec3 parts = facing * middle;
  const float size = max(max(abs(d.x), abs(d.y)), abs(d.z)) + float(side);
  return abs(parts.x + parts.y + parts.z) > 0.5 * float(side) + size * (1.0 / 262144.0) + 1.0;
}

void begin(uint32_t lane, uint32_t item) {
  no_pose(lane);
  if (item >= list_count(kListNearRuns)) return;
  const NearRun part = near_runs[item];
  take_pose(part.pose);
  put_pose(lane);
  const uint32_t place = part.run * kRunSize + lane % kRunSize;
  if (place >= scene.tool.triangles || (record_flags(place) & kInfoCollapsed) != 0u)
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

// Of a word of voxels from `low` on, a lattice point, those in whose way the plane lies: as off_plane().
uint32_t on_plane(ivec3 low) {
  const float size = float(scene.mockup.grid.size);
  const vec3 d = vec3(low - origin), parts = facing * (d + 0.5 * size);
  const float most = max(max(abs(d.x), abs(d.y)), abs(d.z)) + 8.0 * size,
              reach = 0.5 * size + most * (1.0 / 262144.0) + 1.0;
  const float at = parts.x + parts.y + parts.z, along_x = facing.x * size, along_y = facing.y * size;
  uint32_t bits = 0u;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      bits |= uint32_t(abs(at + along_x * float(x) + along_y * float(y)) <= reach) << (8 * y + x);
  return bits;
}

// Of a word those between low and high, of the brick's eight, along x and y.
uint32_t in_box(ivec3 low, ivec3 high) {
  const uint32_t row = (2u << high.x) - (1u << low.x);
  const int32_t from = max(low.y - 4 * half_y, 0), to = min(high.y - 4 * half_y, 3);
  return row * 0x01010101u & 0xFFFFFFFFu << 8 * from & 0xFFFFFFFFu >> 8 * (3 - to);
}

// Reserves n places. False: there is no room in this round.
bool take_places(uint32_t n, out uint32_t at) {
  at = atomicAdd(found_count, n);
  if (at + n <= kRoom) return true;
  for (uint32_t i = at; i < kRoom; ++i) found[i] = kNothing;
  return false;
}

void next_brick() {
  z = -1;
  more = any(notEqual(brick, high_brick));
  const bool end_x = brick.x == high_brick.x, end_y = end_x && brick.y == high_brick.y;
  brick = ivec3(end_x ? low_brick.x : brick.x + 1, end_y ? low_brick.y : brick.y + int32_t(end_x),
                brick.z + int32_t(end_y));
}

// The next word, or what of a brick is told at once. False: no room.
bool step(uint32_t lane) {
  const int32_t size = scene.mockup.grid.size;
  const ivec3 low = max(first - 8 * brick, ivec3(0)), high = min(last - 8 * brick, ivec3(7));
  if (z < 0) {
    z = low.z;
    half_y = low.y >> 2;
  }
  const uint32_t slot = mockup_slot_of(brick);
  const ivec3 brick_low = scene.mockup.grid.origin + 8 * size * brick;
  const bool crossed = slot != kBrickExternal && !off_plane(brick_low, 8 * size),
             mixed = crossed && slot < kBrickInternal;
  uvec3 voxel = uvec3(8 * brick);
  uint32_t bits = uint32_t(crossed);   // of V_int: all of it by its first voxel
  if (mixed) {
    const uint32_t word = uint32_t(half_y | z << 1);
    const uint32_t at = kBrickWords * slot + word;
    bits = (mockup_bricks(at) | mockup_bricks(at + kBrickInternalWord)) & in_box(low, high) &
           on_plane(brick_low + size * ivec3(0, 4 * half_y, z));
    voxel += uvec3(0, 4 * half_y, z);
  }
  uint32_t at;
  if (bits != 0u && !take_places(uint32_t(bitCount(bits)), at)) return false;
  const uint64_t about = uint64_t(lane) << 48 | (mixed ? 0ul : kWholeBrick) | uint64_t(voxel.z) << 32;
  for (; bits != 0u; bits &= bits - 1u) {
    const uint32_t i = uint32_t(findLSB(bits));
    found[at++] = about | uint64_t(voxel.x + (i & 7u) | (voxel.y + (i >> 3)) << 16);
  }
  if (mixed && half_y < high.y >> 2) {
    half_y += 1;
  } else if (mixed && z < high.z) {
    half_y = low.y >> 2;
    z += 1;
  } else {
    next_brick();
  }
  return true;
}

void mark_voxel(uint32_t place, uint32_t boundary, uvec3 voxel) {
  const uint32_t entry = voxel_entry(boundary);
  if (BATCH && entry == kNone) {
    atomicOr(frame_state.overflow, 1u << kListTouchedVoxels);
    return;
  }
  const bool is_new = (atomicOr(voxel_state[entry], kVoxelTouched) & kVoxelTouched) == 0u;
  if (is_new) {
    const uint32_t at = take_room(kListTouchedVoxels, 1u);
    if (at < frame_lists[kListTouchedVoxels].capacity) {
      touched_voxels[at] = uvec4(entry, voxel);
      if (begins_group(at, 1u)) grow_result_groups(0u, groups_to(at + 1u));
    }
  }
  const uint32_t list_begin = mockup_list_begin(boundary), list_end = mockup_list_begin(boundary + 1u);
  const uint32_t chunk = chunk_of(list_end - list_begin, PAIR_CHUNK, kMostChunks),
                 chunks = (list_end - list_begin + chunk - 1u) / chunk;
  if (chunks == 0u) return;
  const uint32_t at = take_room(kListPairChunks, chunks), capacity = frame_lists[kListPairChunks].capacity;
  if (at < capacity && begins_group(at, chunks))
    grow_listed_groups(kGroupsPairs, groups_to(min(at + chunks, capacity)));
  for (uint32_t i = 0u; i < chunks && at + i < capacity && !spent(1u); ++i)
    pair_chunks[at + i] =
        PairChunk(place | (is_new ? kFirstTouch : 0u), list_begin + i * chunk,
                  min(list_begin + (i + 1u) * chunk, list_end), voxel.x | voxel.y << 16, voxel.z, frame_pose);
}

void decide(uint64_t work) {
  if ((work & kNothing) != 0ul) return;
  const uint32_t xy = uint32_t(work), rest = uint32_t(work >> 32);
  const uint32_t lane = rest >> 16 & (kGroupSize - 1u), place = places[lane];
  go_on_for(lane);
  const bool whole = (work & kWholeBrick) != 0ul;
  const ivec3 a = corner_of(lane, 0u), b = corner_of(lane, 1u), c = corner_of(lane, 2u);
  const uvec3 voxel = uvec3(xy & 0xFFFFu, xy >> 16, rest & 0xFFFFu);
  const int32_t size = scene.mockup.grid.size;
  const ivec3 low = scene.mockup.grid.origin + size * ivec3(voxel);
  if (!triangle_touches_box(a, b, c, raw_normal(a, b, c), low, low + (whole ? 8 * size : size))) return;
  const uint32_t boundary = whole ? kNoVoxel : mockup_boundary_index(ivec3(voxel));
  const bool internal = INTERNAL && boundary == kNoVoxel;
  mark_mobile(record_id(place), internal ? kMobileInternal : kMobileBoundary);
  if (!internal) mark_voxel(place, boundary, voxel);
}

void main() {
  const uint32_t lane = gl_LocalInvocationIndex;
  const uint32_t run = lane / kRunSize;
  begin(lane, run < RUNS_A_GROUP ? flat_group() * RUNS_A_GROUP + run : kNone);
  bool again = true;
  while (again) {
    if (lane == 0u) found_count = unfinished = 0u;
    barrier();
    while (more && !spent(kStepCost))
      if (!step(lane)) break;
    if (more && loop_budget < kLoopBudget) unfinished = 1u;
    barrier();
    const uint32_t count = min(found_count, kRoom);
    again = unfinished != 0u;
    for (uint32_t i = lane; i < count && !spent(1u); i += kGroupSize) decide(found[i]);
    barrier();
  }
  tell_left_undone(lane);
}
