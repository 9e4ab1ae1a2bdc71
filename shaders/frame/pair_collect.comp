#version 460
#extension GL_GOOGLE_include_directive : require
// Distinct pairs whose boxes meet. An invocation a PairChunk; one triangle pair lies in many voxels, so a hash table keeps the
// first. Reads both bodies; appends pair_candidates, fills pair_table, marks kStaticListed what is listed in a touched voxel.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_pair.glsl"

READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupListTriangles, uint32_t, mockup_list_triangles);
READ(kBindMobileCorners, ToolCorners, mobile_corners);
READ(kBindPairChunks, uvec3, pair_chunks);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindPairTable, uint64_t, pair_table);
EDIT(kBindPairCandidates, PairCandidate, pair_candidates);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/static_mark.glsl"

// Enters the pair in the table; its slot, or kNone when it was there or found no room.
uint32_t new_slot(uint32_t static_id, uint32_t mobile) {
  const uint64_t key = (uint64_t(static_id) + 1ul) << 32 | uint64_t(mobile);   // never 0, which is an empty slot
  const uint32_t mask = uint32_t(pair_table.length()) - 1u;
  uint32_t slot = uint32_t((key * 0x9E3779B97F4A7C15ul) >> 32);
  for (uint32_t probe = 0u; probe < kPairProbes; ++probe) {
    slot &= mask;
    const uint64_t there = atomicCompSwap(pair_table[slot], 0ul, key);
    if (there == 0ul) return slot;
    if (there == key) return kNone;
    ++slot;
  }
  atomicOr(frame_state.overflow_other, kOverflowPairTable);
  return kNone;
}

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListPairChunks].count) return;
  const uvec3 work = pair_chunks[item];   // PairChunk
  const uint32_t mobile = work.x & ~kFirstTouch;
  const ToolCorners t = mobile_corners[mobile];
  const ivec3 low = min(min(t.a, t.b), t.c), high = max(max(t.a, t.b), t.c);
  bool close = false;
  for (uint32_t i = work.y; i < work.z; ++i) {
    const uint32_t id = mockup_list_triangles[i];
    if ((work.x & kFirstTouch) != 0u) mark_static(id, kStaticListed);
    const uvec3 s = mockup_triangles[id];
    const ivec3 a = mockup_vertices[s.x], b = mockup_vertices[s.y], c = mockup_vertices[s.z];
    const ivec3 apart = max(low - max(max(a, b), c), min(min(a, b), c) - high);   // > 0: the boxes do not meet
    close = close || all(lessThanEqual(apart, ivec3(kCloseSteps)));
    if (any(greaterThan(apart, ivec3(0)))) continue;
    const uint32_t slot = new_slot(id, mobile);
    if (slot == kNone) continue;
    const uint32_t at = atomicAdd(frame_lists[kListPairCandidates].count, 1u);
    if (at < frame_lists[kListPairCandidates].capacity) pair_candidates[at] = PairCandidate(id, mobile, slot);
  }
  if (close) frame_state.close = 1u;
}
