#version 460
// One invocation: a static triangle of a held area. Counts it as common with the area that has it now.
// Reads held statics, static states and slots, slots. Writes the overlaps.
// Before: areas_number. Nobody reads slots[].area of another than a root here: areas_gather may run beside.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindHeldStatics, HeldStatic, held_statics);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindSlots, SlotWork, slots);
EDIT(kBindHeldOverlap, uint32_t, held_overlap);

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_input.held_statics) return;
  const HeldStatic held = held_statics[i];
  if (static_state[held.static_id] == 0u) return;   // not in C_s now
  const uint32_t area = slots[static_slot[held.static_id]].area;
  if (area == kNone) return;
  atomicAdd(held_overlap[area * frame_input.held_areas + held.held_area], 1u);
}
