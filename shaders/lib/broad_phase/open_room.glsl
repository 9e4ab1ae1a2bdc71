// Puts a sample of which the tool's partition leaves open whether it is inside in its list. The including
// shader has frame_lists and frame_state, and open_samples and open_poses, writable.
#ifndef PALPATE_LIB_OPEN_ROOM
#define PALPATE_LIB_OPEN_ROOM
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindListedGroups, listed_groups)

void put_open(FrameSample sample_) {
  const uint32_t at = take_room(kListOpenSamples, 1u);
  if (at >= frame_lists[kListOpenSamples].capacity) return;
  open_samples[at] = sample_;
  if (BATCH) open_poses[at] = frame_pose;
  if (begins_group(at, 1u)) grow_listed_groups_deep(kGroupsOpen, groups_to(at + 1u), LANES);
}
#endif
