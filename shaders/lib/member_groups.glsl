// Room for a slot of C_s or a member of C_m in the stages that go through both.
#ifndef PALPATE_LIB_MEMBER_GROUPS
#define PALPATE_LIB_MEMBER_GROUPS
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindMembersGroups, members_groups)
GROUP_COUNTS(kBindResultGroups, result_groups)

void grow_members(uint32_t at) {
  if (!begins_group(at, 1u)) return;
  grow_members_groups(0u, groups_to(at + 1u));
  grow_result_groups(0u, groups_to(at + 1u));
}
#endif
