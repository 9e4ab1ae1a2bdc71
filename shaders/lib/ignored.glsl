// Contacts that are left out (docs/EXACTNESS.md section 8): whether what would push has its static triangle
// in an ignored patch, which is then listed.
// The including shader has frame_input, WORDS mockup_patches, uint32_t ignored[], and, writable, ignored_state[],
// result_ignored[], frame_lists.
#ifndef PALPATE_LIB_IGNORED
#define PALPATE_LIB_IGNORED
#include "shaders/lib/list_room.glsl"
bool is_ignored(uint32_t static_id) {
  if (BATCH || frame_input.ignores == 0u) return false;   // a batch ignores none
  const uint32_t patch_id = mockup_patches(static_id), word = patch_id >> 5, bit = 1u << (patch_id & 31u);
  if ((ignored[word] & bit) == 0u) return false;
  if ((atomicOr(ignored_state[word], bit) & bit) == 0u) {
    const uint32_t at = take_room(kListIgnored, 1u);
    if (at < frame_lists[kListIgnored].capacity) result_ignored[at] = patch_id;
  }
  return true;
}
#endif
