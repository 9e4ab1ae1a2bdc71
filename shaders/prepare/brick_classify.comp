// One invocation: a brick. Gives a uniform brick its code and a mixed one its internal bits: a component is
// V_int when it does not reach the border (its root is not 0) and its votes are positive. Raises has_internal
// if there is any.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 2) readonly buffer ComponentFirst { uint32_t component_first[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Labels { uint32_t labels[]; };
layout(scalar, set = 0, binding = 4) readonly buffer Parent { uint32_t parent[]; };
layout(scalar, set = 0, binding = 5) readonly buffer Votes { int64_t votes[]; };
layout(scalar, set = 0, binding = 6) buffer HasInternal { uint32_t has_internal; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

bool internal_node(uint32_t node) {
  uint32_t root = parent[node];
  return root != 0u && votes[root] > 0l;
}

void main() {
  uint32_t brick = item_index();
  if (brick >= count) return;
  uint32_t slot = brick_slot[brick];
  bool any_internal = false;
  if (slot >= kBrickInternal) {
    any_internal = internal_node(1u + brick);
    brick_slot[brick] = any_internal ? kBrickInternal : kBrickExternal;
  } else {
    uint32_t first = component_first[slot], components = component_first[slot + 1u] - first;
    for (uint32_t c = 0u; c < components; ++c) {
      if (!internal_node(1u + count + first + c)) continue;
      any_internal = true;
      for (uint32_t w = 0u; w < 16u; ++w) {
        uint32_t mine = ~bricks[slot].boundary[w];
        for (uint32_t plane = 0u; 1u << plane < components; ++plane) {
          uint32_t bits = labels[slot * 128u + plane * 16u + w];
          mine &= (c >> plane & 1u) != 0u ? bits : ~bits;
        }
        bricks[slot].internal_[w] |= mine;
      }
    }
  }
  if (any_internal) atomicMax(has_internal, 1u);
}
