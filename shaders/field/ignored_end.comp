#version 460
// One invocation: an ignored patch that something touched. Leaves the table that is 0 between frames as it was.
// Reads result_ignored. Writes ignored_state.
// Before: the list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindResultIgnored, uint32_t, result_ignored);
EDIT(kBindIgnoredState, uint32_t, ignored_state);

void main() {
  const uint32_t i = flat_invocation();
  if (i < frame_lists[kListIgnored].count) ignored_state[result_ignored[i] >> 5] = 0u;
}
