// Room for items of a list, how many it has, and whether a frame is in contact. The including shader has
// frame_lists and frame_state, both writable.
#ifndef PALPATE_LIST_ROOM_GLSL
#define PALPATE_LIST_ROOM_GLSL
// The place of the first of n items. Who crosses the capacity notes the overflow at once.
uint32_t take_room(uint32_t list, uint32_t n) {
  const uint32_t at = atomicAdd(frame_lists[list].count, n);
  const uint32_t capacity = frame_lists[list].capacity;
  // In a batch each pose notes its own.
  if ((BATCH || at <= capacity) && n > capacity - min(at, capacity))
    atomicOr(frame_state.overflow, 1u << list);
  return at;
}

// Of a list that nobody appends to any more.
uint32_t list_count(uint32_t list) { return min(frame_lists[list].count, frame_lists[list].capacity); }

// When the sets are known.
bool in_contact() {
  return frame_state.meets != 0u && (frame_state.overflow & ~kOverflowAfterSets) == 0u &&
         (frame_state.overflow_other & kOverflowLoop) == 0u;
}

// How many of `count` entries a chunk takes: `usual`, or as many as make `most` chunks.
uint32_t chunk_of(uint32_t count, uint32_t usual, uint32_t most) {
  return max(usual, (count + most - 1u) / most);
}
#endif
