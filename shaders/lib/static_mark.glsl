// Sets a bit of a static triangle's state; the first one gives it a slot in C_s. The including file has static_state,
// static_slot, contact_statics, frame_lists and frame_state.
#ifndef PALPATE_STATIC_MARK_GLSL
#define PALPATE_STATIC_MARK_GLSL
void mark_static(uint32_t id, uint32_t bit) {
  if (bit != kStaticListed) frame_state.meets = 1u;   // whoever writes it
  if (atomicOr(static_state[id], bit) != 0u) return;
  const uint32_t slot = atomicAdd(frame_lists[kListContactStatics].count, 1u);
  static_slot[id] = slot;
  if (slot < frame_lists[kListContactStatics].capacity) contact_statics[slot] = id;
}
#endif
