#version 460
#extension GL_GOOGLE_include_directive : require
// Empties all lists and the state of the frame before; sets the group count over the bricks in reach.
// One workgroup; invocation i handles list i. Reads frame_input; writes frame_lists, frame_state, dispatches.
#include "shaders/lib/frame.glsl"

READ_ONE(kBindFrameInput, FrameInput, frame_input);
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
  if (i < kDispatchCount && i != kDispatchBricks) dispatches[i] = DispatchArguments(0u, 0u, 0u);
  if (i == 0u) {
    frame_state = FrameState(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
    const uvec3 n = uvec3(frame_input.brick_last - frame_input.brick_first + 1);
    dispatches[kDispatchBricks] = groups_for((n.x * n.y * n.z + kGroupSize - 1u) / kGroupSize);
  }
}
