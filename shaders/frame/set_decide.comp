#version 460
#extension GL_GOOGLE_include_directive : require
// `paper`: is there contact, and how many groups the response needs. A lone invocation. Reads frame_lists,
// frame_state; writes dispatches.
// Before: the lists of C_s, C_m and touched voxels are whole.
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
EDIT(kBindDispatches, DispatchArguments, dispatches);

#include "shaders/lib/list_room.glsl"

void main() {
  if (gl_LocalInvocationIndex != 0u) return;
  const bool contact = in_contact();
  dispatches[kDispatchContactOne] = groups_for(contact ? 1u : 0u);
  dispatches[kDispatchContactStatics] = items_for(contact ? list_count(kListContactStatics) : 0u);
  dispatches[kDispatchContactMobiles] = items_for(contact ? list_count(kListContactMobiles) : 0u);
  dispatches[kDispatchTouchedVoxels] = items_for(contact ? list_count(kListTouchedVoxels) : 0u);
  dispatches[kDispatchContactClusters] =
      groups_for(contact ? (scene.tool.triangles + kClusterSize - 1u) / kClusterSize : 0u);
  dispatches[kDispatchAreaMembers] = groups_for(0u);
}
