#version 460
// One workgroup for all areas: n_c by docs/EXACTNESS.md section 6.
// Reads areas. Writes areas[].direction and flags.
// Before: areas_gather, mobile_normals.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/direction.glsl"

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize) {
    const i64vec3 sum =
        areas[area].zones > 1u ? -vector_of(areas[area].mobile_sum) : vector_of(areas[area].static_sum);
    if (sum == i64vec3(0l)) areas[area].flags = kAreaFlagCancelled | kAreaFlagNoDirection;
    else areas[area].direction = normalise(sum);
  }
}
