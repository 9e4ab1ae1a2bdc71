#version 460
#extension GL_GOOGLE_include_directive : require
// `paper`: names the sets. An invocation a slot of C_s and a member of C_m. Counts into frame_state, writes
// result_statics and result_mobiles.
#include "shaders/lib/frame.glsl"
CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
#include "shaders/lib/set_name.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i < list_count(kListContactStatics)) name_static(i);
  if (i < list_count(kListContactMobiles)) name_mobile(i);
}
