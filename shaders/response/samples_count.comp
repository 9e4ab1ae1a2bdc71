#version 460
// One invocation: a counting sample. Counts it for its triangle: all samples of a triangle have one normal and one weight.
// Reads samples, static slots. Writes slots[].samples.
// Before: areas_begin.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindSlots, SlotWork, slots);

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListSamples].count) return;
  atomicAdd(slots[static_slot[frame_samples[i].static_id]].samples, 1u);
}
