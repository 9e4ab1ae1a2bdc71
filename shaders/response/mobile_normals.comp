#version 460
// One invocation: a member of an area that needs mobile normals. Adds the tool triangle's rotated normal for each of its samples.
// Reads members, mobile_work, the tool's normals and weights. Writes areas[].mobile_sum, mobile_weight.
// Before: mobile_samples (`paper`: areas_first).
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 0) const bool REFINED = true;

CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindResultMembers, AreaMember, members);
READ(kBindMobileWork, MobileWork, mobile_work);
READ(kBindToolNormals, ivec3, tool_unit_normals);
READ(kBindToolWeights, uint32_t, tool_weights);
EDIT(kBindAreas, AreaWork, areas);

// n̂' = (R·n̂ + 2^29) >> 30.
int64_t rotated(ivec3 n, int r) {
  return (int64_t(frame_input.rotation_q30[3 * r]) * int64_t(n.x) + int64_t(frame_input.rotation_q30[3 * r + 1]) * int64_t(n.y) +
          int64_t(frame_input.rotation_q30[3 * r + 2]) * int64_t(n.z) + (1l << 29)) >> 30;
}

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListMembers].count) return;
  const AreaMember member = members[i];
  if ((areas[member.area].state & kAreaWantsMobile) == 0u) return;
  const ivec3 n = tool_unit_normals[member.mobile];
  if (!REFINED) {
    for (int r = 0; r < 3; ++r) atomicAdd(areas[member.area].mobile_sum[r], rotated(n, r));
    return;
  }
  const int64_t samples = int64_t(mobile_work[member.mobile].samples);
  if (samples == 0l) return;
  const int64_t w = int64_t(tool_weights[member.mobile]);
  for (int r = 0; r < 3; ++r) atomicAdd(areas[member.area].mobile_sum[r], samples * ((w * rotated(n, r)) >> 30));
  atomicAdd(areas[member.area].mobile_weight, samples * w);
}
