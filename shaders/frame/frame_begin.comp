#version 460
#extension GL_GOOGLE_include_directive : require
// Empties all lists and the state of the frame before; sets the group count over what the host found near.
// One workgroup; invocation i handles list i. Reads frame_input; writes frame_lists, frame_state, dispatches.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);

void main() {
  const uint32_t i = gl_LocalInvocationIndex;
  if (i < kListCount) {
    frame_lists[i].count = 0u;
    frame_lists[i].asked = 0u;
    frame_lists[i].items = DispatchArguments(0u, 0u, 0u);
    frame_lists[i].groups = DispatchArguments(0u, 0u, 0u);
  }
  if (i < kDispatchCount && i != kDispatchNear) dispatches[i] = DispatchArguments(0u, 0u, 0u);
  if (i == 0u) {
    frame_state = FrameState(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
    dispatches[kDispatchNear] = groups_for((frame_input.near_triangles + kGroupSize - 1u) / kGroupSize);
  }
}
