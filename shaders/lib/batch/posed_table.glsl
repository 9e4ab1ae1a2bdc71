// Tables by pose and number. In a lone frame the entry of a number is the number; in a batch keys are hashed.
//   POSED_TABLE(static, kBindStaticKeys)   static_keys[], and by entry static_id() and static_pose();
//                                          static_entry(id) enters the invocation's pose and `id`, kNone:
//                                          there is no room.
#ifndef PALPATE_LIB_POSED_TABLE
#define PALPATE_LIB_POSED_TABLE
#include "shaders/shared/frame_batch.h"

// 2^64 / golden ratio; the highest bits of the product hang on all of the key's. entries: 2^n, n > 0.
uint32_t first_probe(uint64_t key, uint32_t entries) {
  return uint32_t((key * 0x9E3779B97F4A7C15ul) >> uint32_t(64 - findMSB(entries)));
}

#define POSED_TABLE(NAME, BIND)                                                      \
  EDIT(BIND, uint64_t, NAME##_keys);                                                 \
  uint32_t NAME##_id(uint32_t entry) {                                               \
    return BATCH ? uint32_t(NAME##_keys[entry] - 1ul) : entry;                       \
  }                                                                                  \
  uint32_t NAME##_pose(uint32_t entry) {                                             \
    return BATCH ? uint32_t((NAME##_keys[entry] - 1ul) >> 32) : 0u;                  \
  }                                                                                  \
  uint32_t NAME##_entry(uint32_t id) {                                               \
    if (!BATCH) return id;                                                           \
    const uint64_t key = (uint64_t(frame_pose) << 32 | uint64_t(id)) + 1ul;          \
    const uint32_t entries = uint32_t(NAME##_keys.length());                         \
    uint32_t at = first_probe(key, entries);                                         \
    for (uint32_t probes = 0u; probes < kMostProbes; ++probes) {                     \
      const uint64_t there = atomicCompSwap(NAME##_keys[at], 0ul, key);              \
      if (there == 0ul || there == key) return at;                                   \
      at = (at + 1u) & (entries - 1u);                                               \
    }                                                                                \
    return kNone;                                                                    \
  }
#endif
