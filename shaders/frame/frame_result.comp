#version 460
#extension GL_GOOGLE_include_directive : require
// `paper`: hands the counts to the host and empties tables. Invocation i empties entry i of each list. Reads frame_lists, frame_state; writes the result's head.
// Before: everything else of the frame.
#include "shaders/lib/frame.glsl"
#define STAGE 5   // kStageResult
#include "shaders/lib/stage_end.glsl"
#include "shaders/lib/frame_reset.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i == 0u) write_head();
  reset_entry(i);
  end_stage();
}
