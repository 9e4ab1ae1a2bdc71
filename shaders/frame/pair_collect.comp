#version 460
#extension GL_GOOGLE_include_directive : require
// Distinct pairs whose boxes meet. An invocation a PairChunk; one triangle pair lies in many voxels, so a hash table keeps the
// first. Reads both bodies; appends pair_candidates, fills pair_table.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_pair.glsl"

READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupListTriangles, uint32_t, mockup_list_triangles);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindPairChunks, PairChunk, pair_chunks);
EDIT(kBindPairTable, uint64_t, pair_table);
EDIT(kBindPairCandidates, PairCandidate, pair_candidates);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

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
  const PairChunk work = pair_chunks[item];
  const uvec3 m = tool_triangles[work.mobile];
  const Triangle t = Triangle(tool_world[m.x], tool_world[m.y], tool_world[m.z]);
  for (uint32_t i = work.begin; i < work.end; ++i) {
    const uint32_t id = mockup_list_triangles[i];
    const uvec3 s = mockup_triangles[id];
    if (!boxes_meet(Triangle(mockup_vertices[s.x], mockup_vertices[s.y], mockup_vertices[s.z]), t)) continue;
    const uint32_t slot = new_slot(id, work.mobile);
    if (slot == kNone) continue;
    const uint32_t at = atomicAdd(frame_lists[kListPairCandidates].count, 1u);
    if (at < frame_lists[kListPairCandidates].capacity) pair_candidates[at] = PairCandidate(id, work.mobile, slot);
  }
}
