#version 460
#extension GL_GOOGLE_include_directive : require
// Leaves the tables that are 0 between frames as they were, entry by entry, so that the cost follows the contact.
// Invocation i empties entry i of each list. After an overflow the host clears them whole instead.
#include "shaders/lib/frame.glsl"

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindTouchedVoxels, FrameVoxel, touched_voxels);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindVoxelState, uint32_t, voxel_state);

void main() {
  const uint32_t i = flat_invocation();
  if (i < frame_lists[kListContactStatics].count) static_state[contact_statics[i]] = 0u;
  if (i < frame_lists[kListContactMobiles].count) mobile_state[contact_mobiles[i]] = 0u;
  if (i < frame_lists[kListTouchedVoxels].count) voxel_state[touched_voxels[i].boundary] = 0u;
}
