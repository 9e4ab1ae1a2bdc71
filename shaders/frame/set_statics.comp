#version 460
#extension GL_GOOGLE_include_directive : require
// Names the sets of C_s and starts their results. An invocation a slot; counts into frame_state, writes result_statics.
#include "shaders/lib/frame.glsl"

READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindResultStatics, StaticResult, result_statics);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  const uint32_t id = contact_statics[slot];
  const uint32_t state = static_state[id];
  result_statics[slot] = StaticResult(id, state, kNone, kNone);
  if ((state & kStaticHit) != 0u) {
    atomicAdd(frame_state.cst, 1u);
    return;
  }
  if ((state & kStaticListed) != 0u) atomicAdd(frame_state.bst, 1u);
  if ((state & kStaticSampled) != 0u) atomicAdd(frame_state.est, 1u);
}
