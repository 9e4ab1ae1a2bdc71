#version 460
// One workgroup for all areas: whether some area of several zones needs mobile normals.
// Reads areas. Writes the dispatch of members.
// Before: areas_gather; the list of members is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ(kBindFrameLists, FrameList, frame_lists);
EDIT(kBindDispatches, DispatchArguments, dispatches);
READ_ONE(kBindResponseState, ResponseState, response);
READ(kBindAreas, AreaWork, areas);

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize)
    if (areas[area].zones > 1u)
      dispatches[kDispatchAreaMembers] =
          items_for(min(frame_lists[kListMembers].count,
                        frame_lists[kListMembers].capacity));  // whoever writes it, the same value
}
