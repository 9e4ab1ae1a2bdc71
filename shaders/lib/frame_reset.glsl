// The end of a frame: counts to the host, and all that a frame finds empty as it was. Tables go entry by
// entry, so that the cost follows the contact; after an overflow the host clears them whole. Lists, state and
// group counts are emptied by the last workgroup: until then others read them.
// The including shader has scene, frame_lists and frame_state.
#ifndef PALPATE_LIB_FRAME_RESET
#define PALPATE_LIB_FRAME_RESET
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"
#include "shaders/shared/frame_batch.h"
#include "shaders/shared/frame_field.h"

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
EDIT(kBindNearGroups, DispatchArguments, near_groups);
EDIT(kBindListedGroups, DispatchArguments, listed_groups);
EDIT(kBindPlacedGroups, DispatchArguments, placed_groups);
EDIT(kBindPushedGroups, DispatchArguments, pushed_groups);

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
  if (i < kListCount && i != kListDone) result.asked[i] = frame_lists[i].count;
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

shared bool is_last;

// Of a whole workgroup, at its end.
void leave_anew() {
  const uint32_t lane = gl_LocalInvocationIndex;
  memoryBarrierBuffer();
  barrier();
  if (lane == 0u)
    is_last = atomicAdd(frame_lists[kListDone].count, 1u) + 1u == gl_NumWorkGroups.x * gl_NumWorkGroups.y;
  barrier();
  if (!is_last) return;
  memoryBarrierBuffer();
  if (lane < kListCount) frame_lists[lane].count = 0u;
  const DispatchArguments none = DispatchArguments(0u, 0u, 0u);
  if (lane < 2u) near_groups[lane] = listed_groups[lane] = pushed_groups[lane] = none;
  if (lane != 0u) return;
  members_groups[0] = placed_groups[0] = none;
  result_groups[0] = items_for(scene.refined != 0u ? kFieldWords : 1u);
  frame_state = FrameState(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
}
#endif
