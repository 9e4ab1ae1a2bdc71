#version 460
// One workgroup: hands areas and the swallowed tool to the host.
// Reads areas, response. Writes the frame's result.
// Before: everything else of the response.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
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
    out_area.sheet_sign = areas[area].sheet_sign;
    out_area.rays = areas[area].rays;
    out_area.max_height = areas[area].max_height;
    out_area.height_sum = areas[area].height_sum;
    out_area.weight_sum = areas[area].weight_sum;
    out_area.faded_sum = areas[area].faded_sum;
    out_area.faded_rest = areas[area].faded_rest;
    out_area.weight_slope = areas[area].weight_slope;
    out_area.height_slope = areas[area].height_slope;
    out_area.moment_low = areas[area].moment_low;
    out_area.moment_high = areas[area].moment_high;
    out_area.voxel_sum = areas[area].voxel_sum;
    out_area.voxel_count = areas[area].voxel_count;
    out_area.padding = 0u;
    result.areas[area] = out_area;
  }
  if (gl_LocalInvocationIndex != 0u) return;
  result.area_count = count;
  result.flags = response.swallowed_flags;
  result.swallowed_direction = response.swallowed_direction;
  result.swallowed_height = response.swallowed_steps * uint32_t(scene.mockup.grid.size);   // H = V · k
}
