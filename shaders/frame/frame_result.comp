#version 460
#extension GL_GOOGLE_include_directive : require
// `paper`: hands the counts to the host and empties tables. Invocation i empties entry i of each list. Writes
// the result's head.
// Before: everything else of the frame.
#include "shaders/lib/frame.glsl"
CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
#include "shaders/lib/frame_reset.glsl"

void main() {
  const uint32_t i = flat_invocation();
  write_head(i);
  reset_entry(i);
  leave_anew();
}
