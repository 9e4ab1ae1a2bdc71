// The end of a frame: counts to the host, and the tables that are 0 between frames as they were, entry by
// entry, so that the cost follows the contact. After an overflow the host clears them whole instead. The
// including shader has scene, frame_lists and frame_state.
#ifndef PALPATE_LIB_FRAME_RESET
#define PALPATE_LIB_FRAME_RESET
#include "shaders/lib/list_room.glsl"
#include "shaders/shared/frame_batch.h"

READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindTouchedVoxels, FrameVoxel, touched_voxels);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindVoxelState, uint32_t, voxel_state);
EDIT(kBindStaticKeys, uint64_t, static_keys);
EDIT(kBindMobileKeys, uint64_t, mobile_keys);
EDIT(kBindVoxelKeys, uint64_t, voxel_keys);
READ(kBindPairSlots, uint32_t, pair_slots);
EDIT(kBindPairTable, uint64_t, pair_table);
EDIT_ONE(kBindResult, FrameResult, result);

// Entry i of each list.
void reset_entry(uint32_t i) {
  if (i < list_count(kListContactStatics)) {
    static_state[contact_statics[i]] = 0u;
    if (BATCH) static_keys[contact_statics[i]] = 0ul;
  }
  if (i < list_count(kListContactMobiles)) {
    mobile_state[contact_mobiles[i]] = 0u;
    if (BATCH) mobile_keys[contact_mobiles[i]] = 0ul;
  }
  if (i < list_count(kListTouchedVoxels)) {
    voxel_state[touched_voxels[i].boundary] = 0u;
    if (BATCH) voxel_keys[touched_voxels[i].boundary] = 0ul;
  }
  if (i < list_count(kListPairCandidates)) pair_table[pair_slots[i]] = 0ul;
}

// Invocation i of the first ones.
void write_head(uint32_t i) {
  if (i < kListCount) result.asked[i] = frame_lists[i].count;
  if (i != 0u) return;
  const bool contact = in_contact();
  result.state = frame_state;
  result.state.contact = contact ? 1u : 0u;
  result.pair_count = list_count(kListPairs);
  result.static_count = list_count(kListContactStatics);
  result.mobile_count = list_count(kListContactMobiles);
  result.member_count = scene.refined == 0u && contact ? list_count(kListMembers) : 0u;
  result.ignored_count = list_count(kListIgnored);
  if (scene.refined != 0u || !contact) result.area_count = 0u;   // else the areas have written it
}
#endif
