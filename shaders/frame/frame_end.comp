#version 460
#extension GL_GOOGLE_include_directive : require
// Hands the counts of the response to the host. A lone invocation; reads frame_lists, frame_state; writes the result's head.
#include "shaders/lib/frame.glsl"

READ(kBindFrameLists, FrameList, frame_lists);
READ_ONE(kBindFrameState, FrameState, frame_state);
EDIT_ONE(kBindResult, FrameResult, result);

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  result.state = frame_state;
  result.member_count = frame_lists[kListMembers].count;
  result.ignored_count = frame_lists[kListIgnored].count;
}
