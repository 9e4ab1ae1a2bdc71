// Sets a bit of a tool triangle's state; the first of kMobileSets enters it in C_m. Its samples count as deep
// while it is in IMT, as cut once it is in CMT: V_int voxels are marked before pairs. The including file has
// scene, mobile_state, contact_mobiles, frame_lists and frame_state.
#ifndef PALPATE_MOBILE_MARK_GLSL
#define PALPATE_MOBILE_MARK_GLSL
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(mobile, kBindMobileKeys)
READ(kBindToolSamples, uint32_t, tool_samples);

void count_samples(uint32_t mobile, uint32_t before, uint32_t bit) {
  if (scene.refined == 0u || (before & bit) != 0u) return;
  if (bit == kMobileInternal) atomicAdd(frame_state.deep_samples, tool_samples[mobile]);
  if (bit != kMobileHit) return;
  atomicAdd(frame_state.cut_samples, tool_samples[mobile]);
  if ((before & kMobileInternal) != 0u) atomicAdd(frame_state.deep_samples, 0u - tool_samples[mobile]);
}

void mark_mobile(uint32_t mobile, uint32_t bit) {
  if (bit == kMobileInternal) frame_state.meets = 1u;   // whoever writes it
  const uint32_t entry = mobile_entry(mobile);
  if (BATCH && entry == kNone) {
    atomicOr(frame_state.overflow, 1u << kListContactMobiles);
    return;
  }
  const uint32_t before = atomicOr(mobile_state[entry], bit);
  count_samples(mobile, before, bit);
  if ((before & kMobileSets) != 0u) return;
  if (BATCH) atomicAdd(frame_state.mobiles, 1u);
  const uint32_t at = take_room(kListContactMobiles, 1u);
  if (at >= frame_lists[kListContactMobiles].capacity) return;
  contact_mobiles[at] = entry;
  grow_members(at);
}
#endif
