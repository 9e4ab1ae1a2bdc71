#version 460
#extension GL_GOOGLE_include_directive : require
// Whether bins are needed: there are open samples. A lone invocation; reads frame_lists, starts bin_state, writes dispatches.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindBinState, BinState, bin_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  bin_state = BinState(0u, 0u);
  if (frame_lists[kListOpenSamples].count != 0u) dispatches[kDispatchBinTriangles] = groups_for((scene.tool.triangles + kGroupSize - 1u) / kGroupSize);
}
