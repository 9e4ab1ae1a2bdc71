#version 460
// One invocation: a slot of C_s. It is an area of its own to begin with.
// Reads nothing. Writes parents, slots.
// Before: the list of C_s is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindParents, uint32_t, parents);
EDIT(kBindSlots, SlotWork, slots);

void main() {
  const uint32_t slot = flat_invocation();
  if (slot >= frame_lists[kListContactStatics].count) return;
  parents[2u * slot] = 2u * slot;
  parents[2u * slot + 1u] = 2u * slot + 1u;
  slots[slot] = SlotWork(kNone, 0u);
}
