// One invocation: a brick. Reads the prefix sums of the marks; gives a mixed brick its slot, any other
// kBrickExternal for the time being; writes each slot's brick number.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Sums { uint32_t sums[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t brick = item_index();
  if (brick >= count) return;
  uint32_t slot = sums[brick];
  bool mixed = sums[brick + 1u] != slot;
  brick_slot[brick] = mixed ? slot : kBrickExternal;
  if (mixed) mixed_brick[slot] = brick;
}
