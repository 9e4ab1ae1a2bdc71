#version 460
#extension GL_GOOGLE_include_directive : require
// Is there contact, and how many groups the response needs; the sets' counts go to the host. A lone invocation.
// Reads frame_lists, frame_state; writes dispatches, starts result. An overflow before this leaves the response out.
#include "shaders/lib/frame.glsl"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);
EDIT_ONE(kBindResult, FrameResult, result);

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  const uint32_t most = max(max(frame_lists[kListContactStatics].count, frame_lists[kListContactMobiles].count), frame_lists[kListTouchedVoxels].count);
  const bool whole = (frame_state.overflow | frame_state.overflow_other) == 0u;
  const bool contact = whole && frame_state.cst + frame_state.imt + frame_state.est != 0u;
  // Without contact nobody comes after this.
  dispatches[contact ? kDispatchReset : kDispatchResetFree] = groups_for((most + kGroupSize - 1u) / kGroupSize);
  result.area_count = 0u;   // what the response writes, when it runs
  if (contact) {
    frame_state.contact = 1u;
    dispatches[kDispatchContactOne] = DispatchArguments(1u, 1u, 1u);
    dispatches[kDispatchContactStatics] = frame_lists[kListContactStatics].items;
    dispatches[kDispatchContactMobiles] = frame_lists[kListContactMobiles].items;
    dispatches[kDispatchTouchedVoxels] = frame_lists[kListTouchedVoxels].items;
  }
  result.state = frame_state;
  result.pair_count = frame_lists[kListPairs].count;
  result.static_count = frame_lists[kListContactStatics].count;
  result.mobile_count = frame_lists[kListContactMobiles].count;
  result.member_count = 0u;
  result.ignored_count = 0u;
}
