// One invocation: a mixed brick. Reads the prefix sums of the bricks' boundary voxels, numbers this brick's:
// writes first[] of the brick and the place (slot · 512 + bit) of each of its boundary voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Sums { uint32_t sums[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer BoundaryPlace { uint32_t boundary_place[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t slot = item_index();
  if (slot >= count) return;
  uint32_t next = sums[slot];
  for (uint32_t w = 0u; w < 16u; ++w) {
    bricks[slot].first[w] = next;
    for (uint32_t rest = bricks[slot].boundary[w]; rest != 0u; rest &= rest - 1u)
      boundary_place[next++] = slot * 512u + w * 32u + uint32_t(findLSB(rest));
  }
}
