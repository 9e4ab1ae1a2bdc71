#version 460
// One workgroup for all areas (`refined`): who is a needle, and whether there is anybody to pierce.
// Reads areas. Writes areas[].state and flags, dispatches.
// Before: heights_sum.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindDispatches, DispatchArguments, dispatches);
READ_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize) {
    if (areas[area].cst == 0u || areas[area].direction == ivec3(0) || areas[area].rays != 0u) continue;
    areas[area].state |= kAreaNeedle;
    areas[area].flags |= kAreaFlagNeedle;
    dispatches[kDispatchNeedlePairs] = frame_lists[kListPairs].items;   // whoever writes it, the same value
  }
  if (gl_LocalInvocationIndex != 0u || count < 2u) return;
  const uint32_t boxes = (frame_lists[kListContactStatics].count + kSlotBox - 1u) / kSlotBox;
  dispatches[kDispatchPierceBoxes] = groups_for((boxes + kGroupSize - 1u) / kGroupSize);
  dispatches[kDispatchPierce] = frame_lists[kListSamples].items;
}
