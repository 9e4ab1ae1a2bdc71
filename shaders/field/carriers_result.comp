#version 460
// One invocation: a slot of C_s. Hands what it carries to the host, if it is in CST or EST.
// Reads C_s, carrier_work. Writes result_carriers.
// Before: all pushes are added.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindCarrierWork, int64_t, carrier_work);
EDIT(kBindResultCarriers, int64_t, result_carriers);

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count || (static_state[contact_statics[slot]] & (kStaticHit | kStaticSampled)) == 0u) return;
  for (uint32_t i = kCarrierWords * slot; i < kCarrierWords * (slot + 1u); ++i) result_carriers[i] = carrier_work[i];
}
