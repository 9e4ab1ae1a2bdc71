#version 460
#extension GL_GOOGLE_include_directive : require
// Names the sets of C_m. An invocation a member; counts into frame_state, writes result_mobiles.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/plan.glsl"

READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindMobileState, uint32_t, mobile_state);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindResultMobiles, MobileResult, result_mobiles);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListContactMobiles].count) return;
  const uint32_t mobile = contact_mobiles[item];
  const uint32_t state = mobile_state[mobile];
  result_mobiles[item] = MobileResult(mobile, state);
  if ((state & kMobileHit) != 0u)
    atomicAdd(frame_state.cmt, 1u);
  else if (INTERNAL && (state & kMobileInternal) != 0u)
    atomicAdd(frame_state.imt, 1u);
  else
    atomicAdd(frame_state.bmt, 1u);
}
