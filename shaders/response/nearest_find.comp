#version 460
// One invocation: a brick of the mock-up's grid and a request. First the smallest distance of a V_ext voxel's centre, then (NUMBER)
// the smallest voxel number at that distance.
// Reads the partition, requests. Writes request[].distance, or request[].voxel.
// Before: areas_direct; for NUMBER the distances.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/lib/plan.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 1) const bool NUMBER = false;

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slots);
READ(kBindMockupBricks, Brick, mockup_bricks);
EDIT_ONE(kBindResponseState, ResponseState, response);

// |2·centre − 2p|²: components within 2^30.
uint64_t distance_of(ivec3 voxel, ivec3 p) {
  const i64vec3 d = i64vec3(2 * scene.mockup.grid.origin + (2 * voxel + 1) * scene.mockup.grid.size - 2 * p);
  return uint64_t(d.x * d.x + d.y * d.y + d.z * d.z);
}

void offer(uint32_t r, ivec3 voxel, uint64_t distance) {
  if (!NUMBER) {
    atomicMin(response.request[r].distance, distance);
  } else if (distance == response.request[r].distance) {
    const i64vec3 v = i64vec3(voxel), n = 8l * i64vec3(scene.mockup.grid.bricks);
    atomicMin(response.request[r].voxel, uint64_t(v.x + n.x * (v.y + n.y * v.z)));
  }
}

void main() {
  const uint32_t brick = flat_invocation();
  const ivec3 n = scene.mockup.grid.bricks;
  if (brick >= uint32_t(n.x) * uint32_t(n.y) * uint32_t(n.z)) return;
  const uint32_t r = gl_WorkGroupID.z;
  const uint32_t slot = mockup_brick_slots[brick];
  if (slot == kBrickInternal) return;
  const ivec3 at = ivec3(brick % uint32_t(n.x), brick / uint32_t(n.x) % uint32_t(n.y), brick / uint32_t(n.x) / uint32_t(n.y));
  const ivec3 p = response.request[r].point;

  // The brick's voxel whose centre is nearest; where two are, the lower, which has the smaller number.
  const ivec3 d = p - scene.mockup.grid.origin - 1;
  const ivec3 inside = ivec3(floor_div(d.x, scene.mockup.grid.size), floor_div(d.y, scene.mockup.grid.size),
                             floor_div(d.z, scene.mockup.grid.size));
  const ivec3 nearest = clamp(inside, 8 * at, 8 * at + 7);
  const uint64_t bound = distance_of(nearest, p);
  if (bound > response.request[r].distance) return;   // others do better; a stale value is larger, and only costs time
  if (slot == kBrickExternal) {
    offer(r, nearest, bound);
    return;
  }
  for (uint32_t bit = 0u; bit < 512u; ++bit) {
    const uint32_t word = mockup_bricks[slot].boundary[bit >> 5] | (INTERNAL ? mockup_bricks[slot].internal_[bit >> 5] : 0u);
    if ((word >> (bit & 31u) & 1u) != 0u) continue;
    const ivec3 voxel = 8 * at + ivec3(bit & 7u, bit >> 3 & 7u, bit >> 6);
    offer(r, voxel, distance_of(voxel, p));
  }
}
