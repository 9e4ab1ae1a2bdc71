// Room for a sample inside the tool, in its list and in the stage that sums what it pushes. The including
// shader has frame_lists and frame_state.
#ifndef PALPATE_LIB_SAMPLE_ROOM
#define PALPATE_LIB_SAMPLE_ROOM
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindPlacedGroups, placed_groups)

// Its place; false: there is none.
bool take_sample(out uint32_t at) {
  at = take_room(kListSamples, 1u);
  if (BATCH) atomicAdd(frame_state.samples, 1u);
  if (at >= frame_lists[kListSamples].capacity) return false;
  if (begins_group(at, 1u)) grow_placed_groups_deep(kGroupsMockupPush, groups_to(at + 1u), LANES);
  return true;
}
#endif
