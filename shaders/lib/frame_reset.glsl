// The end of a frame: counts to the host, and the tables that are 0 between frames as they were, entry by entry, so that the cost follows the contact. After an
// overflow the host clears them whole instead. The including shader has lib/stage_end.glsl.
#ifndef PALPATE_LIB_FRAME_RESET
#define PALPATE_LIB_FRAME_RESET

READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindTouchedVoxels, FrameVoxel, touched_voxels);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT_ONE(kBindResult, FrameResult, result);

// Entry i of each list.
void reset_entry(uint32_t i) {
  if (i < frame_lists[kListContactStatics].count) static_state[contact_statics[i]] = 0u;
  if (i < frame_lists[kListContactMobiles].count) mobile_state[contact_mobiles[i]] = 0u;
  if (i < frame_lists[kListTouchedVoxels].count) voxel_state[touched_voxels[i].boundary] = 0u;
}

void write_head() {
  result.state = frame_state;
  result.pair_count = frame_lists[kListPairs].count;
  result.static_count = frame_lists[kListContactStatics].count;
  result.mobile_count = frame_lists[kListContactMobiles].count;
  result.member_count = scene.refined == 0u && frame_state.contact != 0u ? frame_lists[kListMembers].count : 0u;
  result.ignored_count = scene.refined != 0u ? frame_lists[kListIgnored].count : 0u;
  if (scene.refined != 0u || frame_state.contact == 0u) result.area_count = 0u;   // else the areas have written it
}
#endif
