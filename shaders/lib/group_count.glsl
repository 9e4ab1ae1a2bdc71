// Group counts of later stages, which grow with the lists that those go through.
//   GROUP_COUNTS(kBindMembersGroups, members_groups)   the buffer, and grow_members_groups(which, groups):
//                                                      so many at least; grow_members_groups_deep(which,
//                                                      groups, depth): along z so many of each.
#ifndef PALPATE_LIB_GROUP_COUNT
#define PALPATE_LIB_GROUP_COUNT

#define GROUP_COUNTS(BIND, NAME)                                                  \
  EDIT(BIND, DispatchArguments, NAME);                                            \
  void grow_##NAME##_deep(uint32_t which, uint32_t groups, uint32_t depth) {      \
    atomicMax(NAME[which].x, min(groups, kMaxGroupsX));                           \
    atomicMax(NAME[which].y, (groups + kMaxGroupsX - 1u) / kMaxGroupsX);          \
    atomicMax(NAME[which].z, depth);                                              \
  }                                                                               \
  void grow_##NAME(uint32_t which, uint32_t groups) { grow_##NAME##_deep(which, groups, 1u); }

// Whether n > 0 items from `at` on begin a workgroup, and how many there are up to the last of them.
bool begins_group(uint32_t at, uint32_t n) { return (at + n - 1u) / kGroupSize != (at - 1u) / kGroupSize; }
uint32_t groups_to(uint32_t end) { return (end + kGroupSize - 1u) / kGroupSize; }
#endif
