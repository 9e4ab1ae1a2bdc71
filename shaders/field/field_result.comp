#version 460
// One invocation: a word of the field, a slot of C_s, an ignored patch, an entry of each list; in a batch a
// word of the fields of all poses. Hands them to the host, and empties what is 0 between frames.
// Reads field_work, carrier_work, frame_lists, frame_state. Writes the results.
// Before: all pushes are added.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"
CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
#include "shaders/lib/frame_reset.glsl"

layout(constant_id = 8) const bool CARRIERS = true;   // as in lib/field_sums.glsl
layout(constant_id = 9) const bool FIELD = true;       // false: of a batch that has none, of which the states are all

EDIT(kBindFieldWork, int64_t, field_work);
READ(kBindCarrierWork, int64_t, carrier_work);
READ(kBindResultIgnored, uint32_t, result_ignored);
EDIT(kBindIgnoredState, uint32_t, ignored_state);
EDIT(kBindResultField, int64_t, result_field);
EDIT(kBindResultCarriers, int64_t, result_carriers);
EDIT(kBindResultStates, FrameState, result_states);

void hand_out_carrier(uint32_t slot) {
  if (slot >= list_count(kListContactStatics) ||
      (static_state[contact_statics[slot]] & (kStaticHit | kStaticSampled)) == 0u)
    return;
  for (uint32_t word = kCarrierWords * slot; word < kCarrierWords * (slot + 1u); ++word)
    result_carriers[word] = carrier_work[word];
}

void hand_out_batch(uint32_t i) {
  const uint32_t poses = list_count(kListPoses);
  if (i < kListCount) result.asked[i] = frame_lists[i].count;
  if (i < poses) {
    frame_pose = i;
    result_states[i] = frame_state;
    result_states[i].contact = in_contact() ? 1u : 0u;
  }
  if (FIELD && i < poses * kFieldWords) {
    frame_pose = i / kFieldWords;
    if (in_contact()) {
      result_field[i] = field_work[i];
      field_work[i] = 0l;
    }
  }
  if (CARRIERS) hand_out_carrier(i);
}

void main() {
  const uint32_t i = flat_invocation();
  if (BATCH) {
    hand_out_batch(i);
    reset_entry(i);
    return;
  }
  write_head(i);
  if (in_contact()) {
    if (i < kFieldWords) {
      result_field[i] = field_work[i];
      field_work[i] = 0l;
    }
    if (CARRIERS) hand_out_carrier(i);
    const uint32_t all = gl_NumWorkGroups.x * gl_NumWorkGroups.y * kGroupSize;
    for (uint32_t patch_at = i; patch_at < list_count(kListIgnored); patch_at += all)
      ignored_state[result_ignored[patch_at] >> 5] = 0u;
  }
  reset_entry(i);
  leave_anew();
}
