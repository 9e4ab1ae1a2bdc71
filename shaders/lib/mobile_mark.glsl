// Sets a bit of a tool triangle's state; the first of kMobileSets enters it in C_m. The including file has
// mobile_state, contact_mobiles, frame_lists and frame_state.
#ifndef PALPATE_MOBILE_MARK_GLSL
#define PALPATE_MOBILE_MARK_GLSL
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(mobile, kBindMobileKeys)

void mark_mobile(uint32_t mobile, uint32_t bit) {
  if (bit == kMobileInternal) frame_state.meets = 1u;   // whoever writes it
  const uint32_t entry = mobile_entry(mobile);
  if (BATCH && entry == kNone) {
    atomicOr(frame_state.overflow, 1u << kListContactMobiles);
    return;
  }
  const uint32_t before = atomicOr(mobile_state[entry], bit);
  if ((before & kMobileSets) != 0u) return;
  if (BATCH) atomicAdd(frame_state.mobiles, 1u);
  const uint32_t at = take_room(kListContactMobiles, 1u);
  if (at >= frame_lists[kListContactMobiles].capacity) return;
  contact_mobiles[at] = entry;
  grow_members(at);
}
#endif
