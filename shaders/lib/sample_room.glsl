// Room for a sample inside the tool, in its list and in the stage that weighs it. The including shader has
// frame_lists and frame_state.
#ifndef PALPATE_LIB_SAMPLE_ROOM
#define PALPATE_LIB_SAMPLE_ROOM
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"

// Its place; false: there is none.
bool take_sample(out uint32_t at) {
  at = take_room(kListSamples, 1u);
  if (BATCH) atomicAdd(frame_state.samples, 1u);
  if (at >= frame_lists[kListSamples].capacity) return false;
  if (begins_group(at, 1u)) grow_members_groups(0u, groups_to(at + 1u));
  return true;
}
#endif
