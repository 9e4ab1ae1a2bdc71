// What a sample weighs in the field: in large contacts samples are left out, level by level
// (docs/EXACTNESS.md sections 4 and 8).
// The including shader has scene, frame_input and frame_lists; its lists of samples and of C_m are closed.
#ifndef PALPATE_LIB_SAMPLE_LEVELS
#define PALPATE_LIB_SAMPLE_LEVELS
#include "shaders/shared/frame_field.h"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/sample.glsl"

// 256 log2(count), count > 0, straight between powers of two.
uint32_t log_q8(uint32_t count) {
  const uint32_t whole = uint32_t(findMSB(count));
  return 256u * whole + uint32_t(uint64_t(count) << 8 >> whole) - 256u;
}

// By how many levels, Q8, samples are too many.
uint32_t levels_beyond(uint32_t count) {
  const uint32_t wanted = scene.contact_samples;
  return wanted != 0u && count > wanted ? log_q8(count) - log_q8(wanted) : 0u;
}

// Of this frame, Q8: of the mock-up's samples, and of the tool's, of which it is guessed how many are inside.
uvec2 frame_levels() {
  const uint32_t most = 256u * kMostSurfaceLevel,
                 samples = BATCH ? frame_state.samples : list_count(kListSamples),
                 mobiles = BATCH ? frame_state.mobiles : list_count(kListContactMobiles),
                 deep = frame_state.deep_samples, cut = min(frame_state.cut_samples / 2u, samples),
                 mockup = max(min(levels_beyond(samples + mobiles / 16u), most), levels_beyond(deep / 4u)),
                 tool = max(mockup, min(levels_beyond(deep + cut), most));
  return min(uvec2(mockup, tool) + INPUT(coarser), uvec2(256u * kMostSampleLevel));
}
uint32_t mockup_level() { return frame_levels().x; }
uint32_t tool_level() { return frame_levels().y; }

// Q30. `weights`: an extra sample's; `now`: of its body.
uint64_t extra_weight(uint32_t weights[kMostSurfaceLevel + 1u], uint32_t now) {
  const uint32_t part = now & 255u, level = min(now >> 8, kMostSurfaceLevel),
                 next = min(level + 1u, kMostSurfaceLevel);
  return (uint64_t(256u - part) * (uint64_t(weights[level]) << level) +
          uint64_t(part) * (uint64_t(weights[next]) << next)) >>
         8;
}

// LEVELS: WORDS (kBindMockupLevels of shared/frame_field.h).
#define SAMPLE_WEIGHT(NAME, LEVELS, TRIANGLES)                                                                 \
  uint64_t NAME##_at(uint32_t base, uint32_t place, uint32_t level, uint32_t wanted) {                         \
    const uint32_t words = TRIANGLES + kSideLevelWords * (place - 1u), taken = min(wanted, LEVELS(words));     \
    if (level < taken) return 0ul;                                                                             \
    return taken == 0u ? uint64_t(base) : (uint64_t(base) * uint64_t(LEVELS(words + taken)) >> 30) << taken;   \
  }                                                                                                            \
  /* Q30. `base`: the triangle's field weight; `level`: the last one of the sample; `now`: its body's. */      \
  uint64_t NAME(uint32_t triangle, uint32_t base, uint32_t level, uint32_t now) {                              \
    const uint32_t place = LEVELS(triangle), part = now & 255u;                                                \
    if (place == 0u || now == 0u) return uint64_t(base);                                                       \
    return (uint64_t(256u - part) * NAME##_at(base, place, level, now >> 8) +                                  \
            uint64_t(part) * NAME##_at(base, place, level, (now >> 8) + 1u)) >>                                \
           8;                                                                                                  \
  }
#endif
