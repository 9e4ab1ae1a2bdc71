// Sets a bit of a static triangle's state; the first one gives it a slot in C_s. The including file has
// static_state, static_slot, contact_statics, frame_lists and frame_state.
#ifndef PALPATE_STATIC_MARK_GLSL
#define PALPATE_STATIC_MARK_GLSL
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"

void mark_static(uint32_t id, uint32_t bit) {
  if (bit != kStaticListed) frame_state.meets = 1u;   // whoever writes it
  if (atomicOr(static_state[id], bit) != 0u) return;
  const uint32_t slot = take_room(kListContactStatics, 1u);
  static_slot[id] = slot;
  if (slot >= frame_lists[kListContactStatics].capacity) return;
  contact_statics[slot] = id;
  grow_members(slot);
}
#endif
