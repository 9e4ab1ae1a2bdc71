#version 460
#extension GL_GOOGLE_include_directive : require
// Whether two triangles intersect, exactly. An invocation a PairCandidate. Reads both bodies; appends pairs, marks CST and CMT.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_pair.glsl"

READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMobileCorners, ToolCorners, mobile_corners);
READ(kBindPairCandidates, PairCandidate, pair_candidates);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindPairs, ContactPair, pairs);
EDIT(kBindFrameLists, FrameList, frame_lists);

#include "shaders/lib/mobile_mark.glsl"
#include "shaders/lib/static_mark.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListPairCandidates].count) return;
  const PairCandidate work = pair_candidates[item];
  const uvec3 s = mockup_triangles[work.static_id];
  const ToolCorners t = mobile_corners[work.mobile];
  if (!triangles_meet(Triangle(mockup_vertices[s.x], mockup_vertices[s.y], mockup_vertices[s.z]),
                      Triangle(t.a, t.b, t.c)))
    return;
  mark_static(work.static_id, kStaticHit);
  mark_mobile(work.mobile, kMobileHit);
  const uint32_t at = atomicAdd(frame_lists[kListPairs].count, 1u);
  if (at < frame_lists[kListPairs].capacity) pairs[at] = ContactPair(work.static_id, work.mobile);
}
