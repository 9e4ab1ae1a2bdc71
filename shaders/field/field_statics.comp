#version 460
// One invocation: a slot of C_s. Empties what it carries, and lists its extra samples.
// Reads C_s, the mock-up's extra samples. Writes carrier_work, mockup_points.
// Before: the list of C_s is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool INSIDE = true;     // the tool has an inside
layout(constant_id = 8) const bool CARRIERS = true;   // as in lib/field_sums.glsl

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupExtras, ExtraSample, extras);
EDIT(kBindCarrierWork, int64_t, carrier_work);
EDIT(kBindMockupPoints, FieldPoint, mockup_points);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/extra_samples.glsl"

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  if (CARRIERS)
    for (uint32_t i = 0u; i < kCarrierWords; ++i) carrier_work[kCarrierWords * slot + i] = 0l;
  const uint32_t id = contact_statics[slot];
  if (!INSIDE || (mockup_info[id] & kInfoHasExtra) == 0u) return;
  const uint32_t first = first_extra(id, scene.mockup_extras), count = extras_from(first, id, scene.mockup_extras);
  const uint32_t at = take_room(kListMockupPoints, count);
  for (uint32_t i = 0u; i < count && at + i < frame_lists[kListMockupPoints].capacity; ++i)
    mockup_points[at + i] = FieldPoint(extras[first + i].point, id, extras[first + i].weight >> 6);
}
