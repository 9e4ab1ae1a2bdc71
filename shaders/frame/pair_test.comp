#version 460
#extension GL_GOOGLE_include_directive : require
// Which triangles of the mock-up intersect which of the tool, exactly: CST and CMT. And what touched voxels
// list: BST. An invocation has a PairChunk: a tool triangle, and entries of the list of a voxel that it
// touches. In each round
//  1. it looks at its next entries, and keeps those whose box in the voxel meets the tool triangle's box and
//     plane;
//  2. the workgroup shares these out, and drops the pairs that another voxel has brought before (pair_table);
//  3. an invocation asks each pair that is left whether its triangles intersect.
// Reads both bodies; appends pairs, marks kStaticHit, kStaticListed and kMobileHit.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_pair.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
TRIPLES(kBindMockupVertices, ivec3, mockup_vertices)
TRIPLES(kBindMockupTriangles, uvec3, mockup_triangles)
WORDS(kBindMockupListTriangles, uint32_t, mockup_list_triangles)
WORDS(kBindListBoxes, uint32_t, list_boxes)
TEXELS(kBindToolRecords, tool_records)
READ(kBindPairChunks, PairChunk, pair_chunks);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindPairTable, uint64_t, pair_table);
EDIT(kBindPairSlots, uint32_t, pair_slots);
EDIT(kBindPairs, ContactPair, pairs);

#include "shaders/lib/batch/group_poses.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/mobile_mark.glsl"
#include "shaders/lib/static_mark.glsl"

// What a round has found among its entries, PAIR_CHUNK an invocation, as static triangle + 2^32 · invocation:
// from the front on what may meet, from the back what is to be marked.
const uint32_t kRoom = 2u * PAIR_CHUNK * kGroupSize;
const uint32_t kEntryCost = 3u;   // with what putting it by takes: what has been reserved is filled
shared uint64_t found[kRoom];
shared uint32_t meet_count, mark_count, unfinished;
shared int32_t corners[9u * kGroupSize];   // of the invocations' tool triangles
shared uint32_t places[kGroupSize];

ivec3 corner_at(uint32_t lane, uint32_t k) {
  const uint32_t at = 9u * lane + 3u * k;
  return ivec3(corners[at], corners[at + 1u], corners[at + 2u]);
}
void put_corner(uint32_t lane, uint32_t k, ivec3 p) {
  for (uint32_t i = 0u; i < 3u; ++i) corners[9u * lane + 3u * k + i] = p[i];
}

uint32_t entry = 0u, end = 0u;   // of the invocation's chunk
bool is_first = false;           // its voxel's list is to be marked
ivec3 low, high;                 // the tool triangle's box, parts of the voxel from its low corner on
vec3 facing;                     // its raw normal, of size 1 by the sum of its components' sizes
float plane, slack;              // along it, parts: from its plane to the voxel's low corner; what may be off

// Parts of a voxel from its low corner on, rounded down; beyond the voxel −1 or kListParts.
ivec3 parts_of(ivec3 d, int32_t size) {
  const ivec3 inside = clamp(d, ivec3(-1), ivec3(size));
  // A float quotient is less than one off; two parts more are looked at for it.
  return ivec3(floor(vec3(inside) * (float(kListParts) / float(size))));
}

void begin(uint32_t lane, uint32_t item) {
  no_pose(lane);
  if (item >= list_count(kListPairChunks)) return;
  const PairChunk work = pair_chunks[item];
  take_pose(work.pose);
  put_pose(lane);
  const uint32_t place = work.place & ~kFirstTouch;
  const RecordCorners r = record_at(place);
  const ivec3 a = world_from_tool(r.a), b = world_from_tool(r.b), c = world_from_tool(r.c);
  places[lane] = place;
  put_corner(lane, 0u, a);
  put_corner(lane, 1u, b);
  put_corner(lane, 2u, c);
  is_first = (work.place & kFirstTouch) != 0u;
  entry = work.begin;
  end = work.end;
  const int32_t size = scene.mockup.grid.size;
  const ivec3 voxel = scene.mockup.grid.origin +
                      size * ivec3(work.xy & 0xFFFFu, work.xy >> 16, work.z);
  low = parts_of(min(min(a, b), c) - voxel, size) - 1;
  high = parts_of(max(max(a, b), c) - voxel, size) + 1;
  const vec3 n = vec3(raw_normal(a, b, c));
  facing = n / (abs(n.x) + abs(n.y) + abs(n.z));
  const vec3 d = vec3(voxel - a), along = facing * d;
  const float parts_a_step = float(kListParts) / float(size);
  plane = (along.x + along.y + along.z) * parts_a_step;
  // facing is off by less than 2^-21, differences, products and sums are rounded: less than 2^-18 of the
  // largest difference, and of the voxel's own parts. A static triangle reaches a part beyond its highs.
  const float most = max(max(abs(d.x), abs(d.y)), abs(d.z)) * parts_a_step + float(kListParts);
  slack = most * (1.0 / 262144.0) + 0.0625;
}

// Whether entry's box in the voxel meets the tool triangle's box and plane. Errs towards true.
bool may_meet(uint32_t box) {
  const ivec3 s_low = ivec3(box & 31u, box >> 5 & 31u, box >> 10 & 31u),
              s_high = ivec3(box >> 15 & 31u, box >> 20 & 31u, box >> 25 & 31u);
  if (any(greaterThan(s_low, high)) || any(lessThan(s_high, low))) return false;
  const vec3 middle = 0.5 * vec3(s_low + s_high + 1), reach = 0.5 * vec3(s_high - s_low + 1);
  const vec3 at = facing * middle, about = abs(facing) * reach;
  return abs(plane + at.x + at.y + at.z) <= about.x + about.y + about.z + slack;
}

// Never 0: an empty entry. In a batch the host has seen to it that all fits (FrameDetection::keys_fit).
uint64_t key_of(uint32_t id, uint32_t place) {
  if (!BATCH) return (uint64_t(id) + 1ul) << 32 | uint64_t(place);
  return ((uint64_t(frame_pose) + 1ul) << (findMSB(scene.mockup.triangles) + 1) | uint64_t(id))
             << (findMSB(scene.tool.triangles) + 1) |
         uint64_t(place);
}

// Enters a pair in the table. False: it is there, or there is no room.
bool is_new(uint32_t id, uint32_t place) {
  const uint64_t key = key_of(id, place);
  const uint32_t entries = uint32_t(pair_table.length());   // 2^n, n > 0
  uint32_t at = first_probe(key, entries), probes = 0u;
  uint64_t there = ~0ul;
  while (there != 0ul && probes++ < entries && !spent(1u)) {
    there = atomicCompSwap(pair_table[at], 0ul, key);
    if (there == key) return false;
    if (there != 0ul) at = (at + 1u) & (entries - 1u);
  }
  // A table that is full has had more pairs than the list has room for: that overflow is noted.
  const uint32_t slot = take_room(kListPairCandidates, 1u);
  if (there != 0ul || slot >= frame_lists[kListPairCandidates].capacity) return false;
  pair_slots[slot] = at;
  if (begins_group(slot, 1u)) grow_result_groups(0u, groups_to(slot + 1u));
  return true;
}

uint64_t work_of(uint32_t listed, uint32_t lane) {
  return uint64_t(mockup_list_triangles(listed)) | uint64_t(lane) << 32;
}

void decide(uint64_t work) {
  const uint32_t id = uint32_t(work), lane = uint32_t(work >> 32), place = places[lane];
  go_on_for(lane);
  if (!is_new(id, place)) return;
  const uvec3 s = mockup_triangles(id);
  if (!triangles_meet(Triangle(mockup_vertices(s.x), mockup_vertices(s.y), mockup_vertices(s.z)),
                      Triangle(corner_at(lane, 0u), corner_at(lane, 1u), corner_at(lane, 2u))))
    return;
  const uint32_t mobile = record_id(place);
  mark_static(id, kStaticHit);
  mark_mobile(mobile, kMobileHit);
  if (BATCH) {   // nobody asks which
    atomicAdd(frame_state.pairs, 1u);
    return;
  }
  const uint32_t at = take_room(kListPairs, 1u);
  if (at < frame_lists[kListPairs].capacity) pairs[at] = ContactPair(id, mobile);
}

void main() {
  const uint32_t lane = gl_LocalInvocationIndex;
  begin(lane, flat_invocation());
  bool again = true;
  while (again) {
    if (lane == 0u) meet_count = mark_count = unfinished = 0u;
    barrier();
    const uint32_t first = entry, last = min(entry + PAIR_CHUNK, end);
    uint32_t meet = 0u;   // bits: which of them may
    for (; entry < last && !spent(kEntryCost); ++entry)
      meet |= uint32_t(may_meet(list_boxes(entry))) << (entry - first);
    if (is_first && first < entry) {
      uint32_t at = kRoom - atomicAdd(mark_count, entry - first);
      for (uint32_t i = first; i < entry; ++i) found[--at] = work_of(i, lane);
    }
    if (meet != 0u) {
      uint32_t at = atomicAdd(meet_count, uint32_t(bitCount(meet)));
      for (; meet != 0u; meet &= meet - 1u) found[at++] = work_of(first + uint32_t(findLSB(meet)), lane);
    }
    if (entry < end && loop_budget < kLoopBudget) unfinished = 1u;
    barrier();
    const uint32_t marks = mark_count, meets = meet_count;
    again = unfinished != 0u;
    for (uint32_t i = lane; i < marks && !spent(1u); i += kGroupSize) {
      const uint64_t work = found[kRoom - 1u - i];
      go_on_for(uint32_t(work >> 32));
      mark_static(uint32_t(work), kStaticListed);
    }
    for (uint32_t i = lane; i < meets && !spent(1u); i += kGroupSize) decide(found[i]);
    barrier();
  }
  tell_left_undone(lane);
}
