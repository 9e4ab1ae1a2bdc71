// The extra samples of a triangle. The including shader has ExtraSample extras[], ascending by triangle, frame_lists and frame_state (both writable).
#ifndef PALPATE_LIB_EXTRA_SAMPLES
#define PALPATE_LIB_EXTRA_SAMPLES
#include "shaders/lib/budget.glsl"
#include "shaders/lib/list_room.glsl"

// The first of `all` whose triangle is not below `id`.
uint32_t first_extra(uint32_t id, uint32_t all) {
  uint32_t low = 0u, high = all;
  while (low < high && !spent(1u)) {
    const uint32_t middle = (low + high) / 2u;
    if (extras[middle].triangle < id) low = middle + 1u;
    else high = middle;
  }
  return low;
}

// How many from there on are of the triangle: at most 1024 (section 4).
uint32_t extras_from(uint32_t first, uint32_t id, uint32_t all) {
  uint32_t count = 0u;
  while (first + count < all && extras[first + count].triangle == id && !spent(1u)) ++count;
  return count;
}
#endif
