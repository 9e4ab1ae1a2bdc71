#version 460
// One invocation: a slot of C_s. Empties what it carries, and lists its extra samples that weigh something.
// Reads C_s, the mock-up's extra samples. Writes carrier_work, mockup_points.
// Before: the lists of samples, C_s and C_m are closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool INSIDE = true;     // the tool has an inside
layout(constant_id = 8) const bool CARRIERS = true;   // as in lib/field_sums.glsl

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupExtras, ExtraSample, extras);
EDIT(kBindCarrierWork, int64_t, carrier_work);
EDIT(kBindMockupPoints, FieldPoint, mockup_points);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/extra_samples.glsl"
#include "shaders/lib/sample_levels.glsl"

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  if (CARRIERS)
    for (uint32_t i = 0u; i < kCarrierWords; ++i) carrier_work[kCarrierWords * slot + i] = 0l;
  const uint32_t id = contact_statics[slot];
  if (!INSIDE || (mockup_info[id] & kInfoHasExtra) == 0u) return;
  const uint32_t first = first_extra(id, scene.mockup_extras), count = extras_from(first, id, scene.mockup_extras);
  for (uint32_t i = 0u; i < count; ++i) {
    const uint32_t weight = uint32_t(extra_weight(extras[first + i].weights) >> 6);
    if (weight == 0u) continue;
    const uint32_t at = take_room(kListMockupPoints, 1u);
    if (at < frame_lists[kListMockupPoints].capacity) mockup_points[at] = FieldPoint(extras[first + i].point, id, weight);
  }
}
