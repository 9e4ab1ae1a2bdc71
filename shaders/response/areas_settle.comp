#version 460
// One workgroup: turns the nearest V_ext voxels that were asked for into directions.
// Reads requests. Writes areas[].direction and flags, the swallowed tool's direction.
// Before: nearest_find, both passes. Runs only if somebody asked.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/direction.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
EDIT_ONE(kBindResponseState, ResponseState, response);
EDIT(kBindAreas, AreaWork, areas);

void main() {
  for (uint32_t r = gl_LocalInvocationIndex; r < response.requests; r += kGroupSize) {
    const NearestRequest request = response.request[r];
    const u64vec3 n = u64vec3(8 * scene.mockup.grid.bricks);
    const ivec3 voxel = ivec3(request.voxel % n.x, request.voxel / n.x % n.y, request.voxel / n.x / n.y);
    const ivec3 centre = scene.mockup.grid.origin + voxel * scene.mockup.grid.size + scene.mockup.grid.size / 2;
    // The grid's border is V_ext, so there always is one; p itself may be a centre.
    const bool found = request.voxel != ~0ul && centre != request.point;
    const ivec3 direction = found ? normalise(i64vec3(centre - request.point)) : ivec3(0);
    const uint32_t flag = found ? kAreaFlagNearestExternal : kAreaFlagNoDirection;
    if (request.area == kNone) {
      response.swallowed_direction = direction;
      response.swallowed_flags |= flag;
    } else {
      areas[request.area].direction = direction;
      areas[request.area].flags |= flag;
    }
  }
}
