#version 460
#extension GL_GOOGLE_include_directive : require
// Empties all lists but those that the host filled, and the state of the frame before; sets their group counts.
// One workgroup; invocation i handles list i. Reads frame_input; writes frame_lists, frame_state, dispatches.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);

void main() {
  const uint32_t i = gl_LocalInvocationIndex;
  if (i < kListCount) {
    const uint32_t count = i == kListTouchCandidates ? frame_input.touch_candidates
                           : i == kListPairCandidates ? frame_input.pair_candidates
                           : i == kListSampleChunks ? frame_input.sample_chunks
                           : i == kListInsideSamples ? frame_input.inside_samples
                           : i == kListOpenSamples ? frame_input.open_samples : 0u;
    frame_lists[i].count = count;
    frame_lists[i].asked = count;
    frame_lists[i].items = groups_for((count + kGroupSize - 1u) / kGroupSize);
    frame_lists[i].groups = DispatchArguments(0u, 0u, 0u);
  }
  if (i < kDispatchCount)
    dispatches[i] = i == kDispatchClusters && frame_input.rays != 0u ? groups_for((scene.tool.triangles + kClusterSize - 1u) / kClusterSize) : DispatchArguments(0u, 0u, 0u);
  if (i == 0u) frame_state = FrameState(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
}
