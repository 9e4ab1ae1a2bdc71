#version 460
#extension GL_GOOGLE_include_directive : require
// Whether this frame needs the whole tool and the samples: only if the bodies may meet. A lone invocation; reads frame_lists,
// frame_state; writes dispatches. (Bodies that keep their distance have no sample inside each other, but for a part of the mock-up
// that lies in the tool as a whole: FrameInput::encloses.)
#include "shaders/lib/frame.glsl"

layout(constant_id = 0) const uint32_t BINS_BITS = 0u;
layout(constant_id = 1) const uint32_t INSIDE = 0u;   // samples are asked whether they lie inside the tool

layout(constant_id = 2) const uint32_t WALK = 0u;     // rays walk through the tool's fine partition and need no tool at its pose

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFrameLists, FrameList, frame_lists);
READ_ONE(kBindFrameState, FrameState, frame_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  const bool meet = INSIDE != 0u ? frame_state.close != 0u || frame_input.encloses != 0u : frame_lists[kListContactMobiles].count != 0u;
  if (!meet) return;
  const uvec3 n = uvec3(frame_input.brick_last - frame_input.brick_first + 1);
  dispatches[kDispatchBricks] = groups_for((n.x * n.y * n.z + kGroupSize - 1u) / kGroupSize);
  if (WALK == 0u) dispatches[kDispatchClusters] = groups_for((scene.tool.triangles + kClusterSize - 1u) / kClusterSize);
  dispatches[kDispatchBins] = groups_for(((1u << 2u * BINS_BITS) + kGroupSize - 1u) / kGroupSize);
}
