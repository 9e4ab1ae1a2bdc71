// The poses of a workgroup's invocations, for shaders in which these share out what they have found: whoever
// goes on with an invocation's find goes on with its pose. Nothing of it is left in a lone frame.
// The including shader has lib/batch/batch.glsl.
#ifndef PALPATE_LIB_GROUP_POSES
#define PALPATE_LIB_GROUP_POSES
shared uint32_t group_poses[kGroupSize];   // kNone: the invocation has no item
shared uint32_t left_undone;

// Of an invocation without an item, and then of one that has taken its pose. A barrier follows.
void no_pose(uint32_t lane) {
  if (!BATCH) return;
  group_poses[lane] = kNone;
  if (lane == 0u) left_undone = 0u;
}
void put_pose(uint32_t lane) {
  if (BATCH) group_poses[lane] = frame_pose;
}

// Goes on with what `lane` has found; only frame_state and tables are that pose's.
void go_on_for(uint32_t lane) {
  if (BATCH) frame_pose = group_poses[lane];
}

// At the end of all: what one had no steps left for may have been any other's.
void tell_left_undone(uint32_t lane) {
  if (!BATCH) {
    tell_spent();
    return;
  }
  if (loop_budget >= kLoopBudget) left_undone = 1u;
  barrier();
  if (left_undone != 0u && group_poses[lane] != kNone)
    atomicOr(frame_states[group_poses[lane]].overflow_other, kOverflowLoop);
}
#endif
