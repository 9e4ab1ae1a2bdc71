#version 460
// One workgroup: hands areas to the host.
// Reads areas, response. Writes the frame's result.
// Before: everything else of the response.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

READ_ONE(kBindResponseState, ResponseState, response);
READ(kBindAreas, AreaWork, areas);
EDIT_ONE(kBindResult, FrameResult, result);

void main() {
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = gl_LocalInvocationIndex; area < count; area += kGroupSize) {
    AreaResult out_area;
    out_area.id = areas[area].id;
    out_area.flags = areas[area].flags;
    out_area.direction = areas[area].direction;
    out_area.rays = areas[area].rays;
    out_area.max_height = areas[area].max_height;
    out_area.voxel_count = areas[area].voxel_count;
    out_area.height_sum = areas[area].height_sum;
    out_area.voxel_sum = areas[area].voxel_sum;
    result.areas[area] = out_area;
  }
  if (gl_LocalInvocationIndex == 0u) result.area_count = count;
}
