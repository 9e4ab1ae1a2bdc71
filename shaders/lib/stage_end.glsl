// The end of a stage: its last workgroup closes the lists that the stage filled, and sets the group counts of the next one. Everybody calls end_stage(), at the
// end of main(), where no invocation has left. The including shader defines STAGE, its kStage… as a digit, and declares none of the buffers below. A stage's
// group counts lie in a buffer of their own, which is read, as the device's commands, while that stage's shaders write those of later ones.
//
// Each subgroup says that it is done, with a word for all of its invocations; whoever completes the sum has all the others' writes before it. Nobody waits.
#ifndef PALPATE_LIB_STAGE_END
#define PALPATE_LIB_STAGE_END
#include "shaders/shared/frame_field.h"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
SHARED(kBindFrameLists, FrameList, frame_lists);
SHARED_ONE(kBindFrameState, FrameState, frame_state);
SHARED(kBindStages, StageProgress, stages);
#if STAGE <= 1
EDIT(kBindMembersGroups, DispatchArguments, members_groups);
EDIT(kBindResultGroups, DispatchArguments, result_groups);
EDIT(kBindDispatches, DispatchArguments, dispatches);
#endif
#if STAGE <= 0
EDIT(kBindListedGroups, DispatchArguments, listed_groups);
#endif
#if STAGE <= 2
EDIT(kBindPlacedGroups, DispatchArguments, placed_groups);
#endif
#if STAGE <= 3
EDIT(kBindPushedGroups, DispatchArguments, pushed_groups);
#endif

DispatchArguments items_for(uint32_t count) { return groups_for((count + kGroupSize - 1u) / kGroupSize); }
uint32_t size_of(DispatchArguments groups) { return groups.x * groups.y; }

// `given`: items that the host put there.
void close_list(uint32_t list, uint32_t given) {
  const uint32_t asked = frame_lists[list].count + given;
  const uint32_t count = min(asked, frame_lists[list].capacity);
  if (count != asked) atomicOr(frame_state.overflow, 1u << list);
  frame_lists[list].asked = asked;
  frame_lists[list].count = count;
  frame_lists[list].items = items_for(count);
  frame_lists[list].groups = groups_for(count);
}

// Each returns the groups of the next stage; where there are none, nobody will end it.
#if STAGE <= 0
uint32_t close_near() {
  close_list(kListTouchedVoxels, 0u);
  close_list(kListStaticChunks, 0u);
  close_list(kListOpenSamples, frame_input.open_samples);
  listed_groups[kGroupsStatics] = items_for(frame_lists[kListStaticChunks].count);
  listed_groups[kGroupsOpen] = items_for(frame_lists[kListOpenSamples].count);
  return stages[kStageListed].groups = size_of(listed_groups[kGroupsStatics]) + size_of(listed_groups[kGroupsOpen]);
}
#endif

#if STAGE <= 1
uint32_t close_listed() {
  close_list(kListPairs, 0u);
  close_list(kListContactStatics, 0u);
  close_list(kListContactMobiles, 0u);
  close_list(kListSamples, 0u);
  const bool contact = frame_state.meets != 0u && (frame_state.overflow | frame_state.overflow_other) == 0u;
  frame_state.contact = contact ? 1u : 0u;
  const uint32_t members = max(frame_lists[kListContactStatics].count, frame_lists[kListContactMobiles].count);
  members_groups[0] = items_for(members);
  result_groups[0] = items_for(max(max(members, frame_lists[kListTouchedVoxels].count), contact ? kFieldWords : 1u));
  stages[kStageResult].groups = size_of(result_groups[0]);
  if (scene.refined == 0u) {
    dispatches[kDispatchContactOne] = groups_for(contact ? 1u : 0u);
    dispatches[kDispatchContactStatics] = items_for(contact ? frame_lists[kListContactStatics].count : 0u);
    dispatches[kDispatchContactMobiles] = items_for(contact ? frame_lists[kListContactMobiles].count : 0u);
    dispatches[kDispatchTouchedVoxels] = items_for(contact ? frame_lists[kListTouchedVoxels].count : 0u);
    dispatches[kDispatchAreaMembers] = groups_for(0u);
  }
  return stages[kStageMembers].groups = size_of(members_groups[0]);
}
#endif

#if STAGE <= 2
uint32_t close_members() {
  close_list(kListFieldTiles, 0u);
  close_list(kListMockupPoints, 0u);
  const uint32_t samples = frame_state.contact != 0u ? size_of(items_for(frame_lists[kListSamples].count)) : 0u;
  placed_groups[kGroupsTiles] = groups_for(frame_lists[kListFieldTiles].count);
  placed_groups[kGroupsMockupPush] = groups_for(samples + size_of(items_for(frame_lists[kListMockupPoints].count)));
  return stages[kStagePlaced].groups = size_of(placed_groups[kGroupsTiles]) + size_of(placed_groups[kGroupsMockupPush]);
}
#endif

#if STAGE <= 3
uint32_t close_placed() {
  close_list(kListToolPoints, 0u);
  pushed_groups[0] = items_for(frame_lists[kListToolPoints].count);
  return stages[kStagePushed].groups = size_of(pushed_groups[0]);
}
#endif

void close_stages() {
#if STAGE == 5
  for (uint32_t list = 0u; list < kListCount; ++list) frame_lists[list].count = 0u;
  for (uint32_t stage = 0u; stage < kStageCount; ++stage) stages[stage].done = 0u;
  frame_state = FrameState(0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u, 0u);
#else
#if STAGE <= 0
  if (close_near() != 0u) return;
#endif
#if STAGE <= 1
  if (close_listed() != 0u) return;
#endif
  if (scene.refined == 0u) return;   // `paper` goes on with a barrier between any two
#if STAGE <= 2
  if (close_members() != 0u) return;
#endif
#if STAGE <= 3
  if (close_placed() != 0u) return;
#endif
  close_list(kListIgnored, 0u);
#endif
}

void end_stage() {
  memoryBarrierBuffer();
  subgroupBarrier();
  if (gl_SubgroupInvocationID != 0u) return;
  const uint32_t mine = kGroupSize / gl_NumSubgroups, groups = STAGE == 0 ? frame_input.groups : stages[STAGE].groups;
  if (atomicAdd(stages[STAGE].done, mine) + mine != kGroupSize * groups) return;
  memoryBarrierBuffer();
  close_stages();
}
#endif
