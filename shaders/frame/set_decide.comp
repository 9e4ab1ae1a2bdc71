#version 460
#extension GL_GOOGLE_include_directive : require
// Is there contact, is the tool swallowed, and how many groups the response needs; the sets' counts go to the host. A lone invocation.
// Reads frame_lists, frame_state; writes dispatches, starts result. An overflow before this leaves the response out.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/plan.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
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
  result.flags = 0u;   // what the response writes, when it runs
  result.area_count = 0u;
  result.swallowed_direction = ivec3(0);
  result.swallowed_height = 0u;
  if (contact) {
    frame_state.contact = 1u;
    const DispatchArguments one = DispatchArguments(1u, 1u, 1u);
    dispatches[kDispatchContactOne] = one;
    dispatches[kDispatchContactStatics] = frame_lists[kListContactStatics].items;
    dispatches[kDispatchContactMobiles] = frame_lists[kListContactMobiles].items;
    dispatches[kDispatchSamples] = frame_lists[kListSamples].items;
    const uint32_t heights = frame_lists[scene.refined != 0u ? kListSamples : kListContactStatics].count;
    dispatches[kDispatchHeightRuns] = groups_for(((heights + kHeightRun - 1u) / kHeightRun + kGroupSize - 1u) / kGroupSize);
    dispatches[kDispatchPairs] = frame_lists[kListPairs].items;
    dispatches[kDispatchTouchedVoxels] = frame_lists[kListTouchedVoxels].items;
    dispatches[kDispatchHeldStatics] = groups_for((frame_input.held_statics + kGroupSize - 1u) / kGroupSize);
    if (INTERNAL && scene.refined != 0u && frame_state.imt != 0u && frame_state.cst + frame_state.est == 0u && frame_lists[kListSamples].count == 0u) {
      frame_state.swallowed = 1u;
      dispatches[kDispatchSwallowedOne] = one;
      dispatches[kDispatchSwallowed] = groups_for(frame_input.near_triangles);
    }
  }
  result.state = frame_state;
  result.pair_count = frame_lists[kListPairs].count;
  result.static_count = frame_lists[kListContactStatics].count;
  result.mobile_count = frame_lists[kListContactMobiles].count;
  result.sample_count = frame_lists[kListSamples].count;
  result.member_count = 0u;
  result.pierce_count = 0u;
}
