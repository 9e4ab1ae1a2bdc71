#version 460
#extension GL_GOOGLE_include_directive : require
// `paper`: names the sets. An invocation a slot of C_s and a member of C_m. Counts into frame_state, writes result_statics and result_mobiles.
#include "shaders/lib/frame.glsl"
#define STAGE 2   // kStageMembers
#include "shaders/lib/stage_end.glsl"
#include "shaders/lib/set_name.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i < frame_lists[kListContactStatics].count) name_static(i);
  if (i < frame_lists[kListContactMobiles].count) name_mobile(i);
  end_stage();
}
