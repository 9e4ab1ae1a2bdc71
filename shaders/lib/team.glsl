// Teams of LANES invocations that follow each other and share an item, of stages whose groups are LANES deep
// along z.
#ifndef PALPATE_LIB_TEAM
#define PALPATE_LIB_TEAM

// The invocation's team in its workgroup, and its place in that.
const uint32_t kTeams = kGroupSize / LANES;
uint32_t team() { return gl_LocalInvocationIndex / LANES; }
uint32_t team_part() { return gl_LocalInvocationIndex % LANES; }

uint32_t team_item() {
  return flat_group() * kGroupSize + (gl_WorkGroupID.z * kGroupSize + gl_LocalInvocationIndex) / LANES;
}
// Which of them says what they have found.
bool speaks() { return team_part() == 0u; }

shared int32_t team_sums[kGroupSize];

// Of the whole workgroup: Σ over the team.
int32_t team_sum(int32_t part) {
  if (LANES == 1u) return part;
  if (speaks()) team_sums[team()] = 0;
  barrier();
  atomicAdd(team_sums[team()], part);
  barrier();
  return team_sums[team()];
}
#endif
