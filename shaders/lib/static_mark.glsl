// Sets a bit of a static triangle's state; the first one gives it a slot in C_s. The including file has
// static_state, static_slot, contact_statics, frame_lists and frame_state (lib/batch/batch.glsl).
#ifndef PALPATE_STATIC_MARK_GLSL
#define PALPATE_STATIC_MARK_GLSL
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/member_groups.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(static, kBindStaticKeys)

// The triangle's entry in the tables by static triangle; kNone: a batch has no room for it.
uint32_t mark_static(uint32_t id, uint32_t bit) {
  if (bit != kStaticListed) frame_state.meets = 1u;   // whoever writes it
  const uint32_t entry = static_entry(id);
  if (BATCH && entry == kNone) {
    atomicOr(frame_state.overflow, 1u << kListContactStatics);
    return entry;
  }
  if (atomicOr(static_state[entry], bit) != 0u) return entry;
  const uint32_t slot = take_room(kListContactStatics, 1u);
  static_slot[entry] = slot;
  if (BATCH) atomicAdd(frame_state.statics, 1u);
  if (slot >= frame_lists[kListContactStatics].capacity) return entry;
  contact_statics[slot] = entry;
  grow_members(slot);
  return entry;
}
#endif
