// Which voxels of the mock-up's grid a box of the tool may meet at the pose. The including shader has scene
// and frame_input.
#ifndef PALPATE_LIB_TURNED_BOX
#define PALPATE_LIB_TURNED_BOX
#include "shaders/lib/pose.glsl"
#include "shaders/lib/voxel_range.glsl"

// Voxels from first to last, cut to the grid, that a closed box in the world touches. False: none.
bool voxels_of(ivec3 low, ivec3 high, out ivec3 first, out ivec3 last) {
  const ivec3 n = 8 * scene.mockup.grid.bricks;
  first = cell_along(low - scene.mockup.grid.origin - 1, scene.mockup.grid.size, n);   // faces are both's
  last = cell_along(high - scene.mockup.grid.origin, scene.mockup.grid.size, n);
  const bool none = any(lessThan(last, ivec3(0))) || any(greaterThanEqual(first, n));
  first = clamp(first, ivec3(0), n - 1);
  last = clamp(last, ivec3(0), n - 1);
  return !none;
}

// The box [low, high] of the tool's own frame, not empty, holds triangles; the world's box holds them at the
// pose. Its half size is off by less than eight roundings, 2^-21 of itself; the turned middle and a turned
// corner are rounded by half a step each.
bool voxels_of_turned(ivec3 low, ivec3 high, out ivec3 first, out ivec3 last) {
  const ivec3 middle = (low + high) >> 1, at = world_from_tool(middle);
  const vec3 half_size = vec3(high - middle);
  ivec3 reach;
  for (int r = 0; r < 3; ++r) {
    const vec3 along = abs(vec3(INPUT(rotation_q30[3 * r]), INPUT(rotation_q30[3 * r + 1]),
                                INPUT(rotation_q30[3 * r + 2]))) *
                       half_size;
    reach[r] = int32_t((along.x + along.y + along.z) * ((1.0 + 1.0 / 1048576.0) / 1073741824.0)) + 3;
  }
  return voxels_of(at - reach, at + reach, first, last);
}
#endif
