// The extra samples of a triangle. The including shader has frame_lists and frame_state (both writable); for
// each body it names its own:
//   EXTRA_SAMPLES(mockup, extras)   first_mockup_extra() and mockup_extras_from() of ExtraSample extras[],
//                                   ascending by triangle.
#ifndef PALPATE_LIB_EXTRA_SAMPLES
#define PALPATE_LIB_EXTRA_SAMPLES
#include "shaders/lib/budget.glsl"
#include "shaders/lib/list_room.glsl"

#define EXTRA_SAMPLES(BODY, EXTRAS)                                                            \
  /* The first of `all` whose triangle is not below `id`. */                                   \
  uint32_t first_##BODY##_extra(uint32_t id, uint32_t all) {                                   \
    uint32_t low = 0u, high = all;                                                             \
    while (low < high && !spent(1u)) {                                                         \
      const uint32_t middle = (low + high) / 2u;                                               \
      if (EXTRAS[middle].triangle < id)                                                        \
        low = middle + 1u;                                                                     \
      else                                                                                     \
        high = middle;                                                                         \
    }                                                                                          \
    return low;                                                                                \
  }                                                                                            \
  /* How many from there on are of the triangle: at most 1024 (section 4). */                  \
  uint32_t BODY##_extras_from(uint32_t first, uint32_t id, uint32_t all) {                     \
    uint32_t count = 0u;                                                                       \
    while (first + count < all && EXTRAS[first + count].triangle == id && !spent(1u)) ++count; \
    return count;                                                                              \
  }
#endif
