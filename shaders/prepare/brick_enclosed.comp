// One invocation: a mixed brick. Writes 1 if one of its components does not reach the border, else 0. Before:
// parents are roots.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(scalar, set = 0, binding = 0) readonly buffer ComponentFirst { uint32_t component_first[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Parent { uint32_t parent[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer Enclosed { uint32_t enclosed[]; };
layout(push_constant, scalar) uniform Push { EnclosedPush push; };

void main() {
  uint32_t slot = item_index();
  if (slot >= push.count) return;
  uint32_t any_enclosed = 0u;
  for (uint32_t c = component_first[slot]; c < component_first[slot + 1u]; ++c)
    if (parent[1u + push.bricks + c] != 0u) any_enclosed = 1u;
  enclosed[slot] = any_enclosed;
}
