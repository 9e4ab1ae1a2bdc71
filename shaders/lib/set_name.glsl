// Names the sets that a slot of C_s, and a member of C_m, are in; counts into frame_state. Starts their results,
// which lie in the host's memory, where somebody looks at them. The including shader has frame_lists and
// frame_state.
#ifndef PALPATE_LIB_SET_NAME
#define PALPATE_LIB_SET_NAME
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/plan.glsl"

layout(constant_id = 8) const bool CARRIERS = true;   // as in lib/field_sums.glsl: somebody looks at triangles

#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(static, kBindStaticKeys)
POSED_TABLE(mobile, kBindMobileKeys)
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindResultStatics, StaticResult, result_statics);
EDIT(kBindResultMobiles, MobileResult, result_mobiles);

void name_static(uint32_t slot) {
  const uint32_t entry = contact_statics[slot], state = static_state[entry];
  if (CARRIERS)
    result_statics[slot] =
        StaticResult(static_id(entry), state, BATCH ? frame_pose : kNone, BATCH ? slot : kNone);
  if ((state & kStaticHit) != 0u) {
    atomicAdd(frame_state.cst, 1u);
    return;
  }
  if ((state & kStaticListed) != 0u) atomicAdd(frame_state.bst, 1u);
  if ((state & kStaticSampled) != 0u) atomicAdd(frame_state.est, 1u);
}

void name_mobile(uint32_t place) {
  const uint32_t entry = contact_mobiles[place], state = mobile_state[entry];
  if (CARRIERS)
    result_mobiles[place] =
        MobileResult(mobile_id(entry), BATCH ? state | frame_pose << kResultPoseShift : state);
  if ((state & kMobileHit) != 0u)
    atomicAdd(frame_state.cmt, 1u);
  else if (INTERNAL && (state & kMobileInternal) != 0u)
    atomicAdd(frame_state.imt, 1u);
  else
    atomicAdd(frame_state.bmt, 1u);
}
#endif
