#version 460
// One invocation: a member of an area. Where the area has several zones, adds the tool triangle's rotated
// normal.
// Reads members, the tool's normals. Writes areas[].mobile_sum.
// Before: areas_first.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindResultMembers, AreaMember, members);
READ(kBindToolNormals, ivec3, tool_unit_normals);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/pose.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i >= min(frame_lists[kListMembers].count, frame_lists[kListMembers].capacity)) return;
  const AreaMember member = members[i];
  if (areas[member.area].zones < 2u) return;
  const ivec3 n = turned(tool_unit_normals[member.mobile]);
  for (int k = 0; k < 3; ++k) atomicAdd(areas[member.area].mobile_sum[k], int64_t(n[k]));
}
