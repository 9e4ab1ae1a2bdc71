#version 460
#extension GL_GOOGLE_include_directive : require
// Whether two triangles intersect, exactly. An invocation a PairCandidate. Reads both bodies; appends pairs,
// marks CST and CMT.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_pair.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindPairCandidates, uint64_t, pair_candidates);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindPairs, ContactPair, pairs);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/mobile_mark.glsl"
#include "shaders/lib/static_mark.glsl"

void decide(uint32_t item) {
  if (item >= frame_input.pair_candidates) return;
  const uint64_t work = pair_candidates[item];   // PairCandidate
  const uint32_t id = uint32_t(work);
  const RecordCorners r = record_at(uint32_t(work >> 32));
  const uvec3 s = mockup_triangles[id];
  if (!triangles_meet(Triangle(mockup_vertices[s.x], mockup_vertices[s.y], mockup_vertices[s.z]),
                      Triangle(world_from_tool(r.a), world_from_tool(r.b), world_from_tool(r.c))))
    return;
  mark_static(id, kStaticHit);
  mark_mobile(r.id, kMobileHit);
  const uint32_t at = take_room(kListPairs, 1u);
  if (at < frame_lists[kListPairs].capacity) pairs[at] = ContactPair(id, r.id);
}

void main() { decide(flat_invocation()); }
