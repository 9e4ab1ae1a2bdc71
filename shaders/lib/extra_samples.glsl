// The extra samples of a triangle. The including shader has frame_lists and frame_state (both writable); for
// each body it names its own:
//   EXTRA_SAMPLES(mockup, extras)   mockup_extras_of() of ExtraSample extras[], ascending by triangle.
#ifndef PALPATE_LIB_EXTRA_SAMPLES
#define PALPATE_LIB_EXTRA_SAMPLES
#include "shaders/lib/budget.glsl"

const uint32_t kMostExtras = 1024u;   // of a triangle (section 4)

#define EXTRA_SAMPLES(BODY, EXTRAS)                                          \
  /* The first of low … high whose triangle is not below `id`. */            \
  uint32_t first_##BODY##_extra(uint32_t id, uint32_t low, uint32_t high) {  \
    while (low < high && !spent(1u)) {                                       \
      const uint32_t middle = (low + high) / 2u;                             \
      if (EXTRAS[middle].triangle < id)                                      \
        low = middle + 1u;                                                   \
      else                                                                   \
        high = middle;                                                       \
    }                                                                        \
    return low;                                                              \
  }                                                                          \
  /* From x to before y. */                                                  \
  uvec2 BODY##_extras_of(uint32_t id, uint32_t all) {                        \
    const uint32_t first = first_##BODY##_extra(id, 0u, all);                \
    return uvec2(first, first_##BODY##_extra(id + 1u, first, min(first + kMostExtras, all))); \
  }
#endif
