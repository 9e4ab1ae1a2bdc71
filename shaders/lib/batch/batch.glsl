// Of which pose an invocation's item is, and that pose. The including shader has frame_input; it gets
// frame_state, the state of the invocation's pose. In a lone frame all of it is entry 0, and frame_input.
#ifndef PALPATE_LIB_BATCH
#define PALPATE_LIB_BATCH
#include "shaders/shared/frame_batch.h"

READ(kBindBatchInputs, FrameInput, batch_inputs);
EDIT(kBindFrameState, FrameState, frame_states);

FrameInput pose_input;   // of a batch

#define frame_state frame_states[frame_pose]
#undef INPUT
#define INPUT(member) (BATCH ? pose_input.member : frame_input.member)

#include "shaders/lib/budget.glsl"

// Before an item is looked at. In a lone frame nothing.
void take_pose(uint32_t pose) {
  if (!BATCH) return;
  tell_spent();
  frame_pose = pose;
  pose_input = batch_inputs[pose];
}
#endif
