// One invocation: a mixed brick. Writes the number of its boundary voxels.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Counts { uint32_t counts[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t slot = item_index();
  if (slot >= count) return;
  uint32_t sum = 0u;
  for (uint32_t w = 0u; w < 16u; ++w) sum += uint32_t(bitCount(bricks[slot].boundary[w]));
  counts[slot] = sum;
}
