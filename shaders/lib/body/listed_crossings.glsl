// What a way crosses of what a voxel lists, shared out among a team. The including shader has body_list_begin[]
// and frame_state (writable), and bool CORNERS(uint32_t entry, bool sheets, out ivec3 a, out ivec3 b,
// out ivec3 c), false where the entry does not count:
//   LISTED_CROSSINGS(body_crossings, body_corners)   int32_t body_crossings(from, to, boundary, sheets): the
//                                                    invocation's part of the sum.
// Floats say it first, for llvmpipe runs exact tests for all lanes that stand side by side as soon as one asks:
// what they leave open, a bit each, is then asked by itself.
#ifndef PALPATE_LIB_LISTED_CROSSINGS
#define PALPATE_LIB_LISTED_CROSSINGS
#include "shaders/lib/budget.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/lib/segment_estimate.glsl"
#include "shaders/lib/team.glsl"

// A perturbed segment that crosses a triangle touches its closed box.
#define LISTED_CROSSINGS(NAME, CORNERS)                                                                 \
  int32_t NAME(ivec3 from, ivec3 to, uint32_t boundary, bool sheets) {                                  \
    const ivec3 low = min(from, to), high = max(from, to);                                              \
    const uint32_t last = body_list_begin[boundary + 1u];                                               \
    uint32_t first = body_list_begin[boundary] + team_part();                                           \
    int32_t net = 0;                                                                                    \
    for (; first < last && !spent(1u); first += 32u * LANES) {                                          \
      uint32_t unsure = 0u;                                                                             \
      ivec3 a, b, c;                                                                                    \
      for (uint32_t i = 0u; i < 32u && first + i * LANES < last && !spent(1u); ++i) {                   \
        if (!CORNERS(first + i * LANES, sheets, a, b, c)) continue;                                     \
        if (any(greaterThan(min(min(a, b), c), high)) || any(lessThan(max(max(a, b), c), low))) continue; \
        const int32_t crossing = segment_estimate(from, to, a, b, c);                                   \
        if (crossing == kUnsure)                                                                        \
          unsure |= 1u << i;                                                                            \
        else                                                                                            \
          net += crossing;                                                                              \
      }                                                                                                 \
      while (unsure != 0u && !spent(1u)) {                                                              \
        CORNERS(first + uint32_t(findLSB(unsure)) * LANES, sheets, a, b, c);                            \
        unsure &= unsure - 1u;                                                                          \
        net += segment_crossing(from, to, a, b, c);                                                     \
      }                                                                                                 \
    }                                                                                                   \
    return net;                                                                                         \
  }
#endif
