// Room for items that come many at a time, or from so many invocations that a count could run round past 2^32 before its list is
// closed. The including shader has frame_lists and frame_state, both writable.
#ifndef PALPATE_LIST_ROOM_GLSL
#define PALPATE_LIST_ROOM_GLSL
// The place of the first of n items. Who crosses the capacity notes the overflow at once.
uint32_t take_room(uint32_t list, uint32_t n) {
  const uint32_t at = atomicAdd(frame_lists[list].count, n);
  const uint32_t capacity = frame_lists[list].capacity;
  if (at <= capacity && n > capacity - at) atomicOr(frame_state.overflow, 1u << list);
  return at;
}

// How many of `count` entries a chunk takes: `usual`, or as many as make `most` chunks.
uint32_t chunk_of(uint32_t count, uint32_t usual, uint32_t most) { return max(usual, (count + most - 1u) / most); }
#endif
