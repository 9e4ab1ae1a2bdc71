// One invocation: a row of bricks along x. Gives every run of uniform bricks in it one parent: node 0 if the
// run reaches the border, else its first brick. Before: every node is its own parent. component_join then
// leaves such neighbours out.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Parent { uint32_t parent[]; };
layout(push_constant, scalar) uniform Push { GridPush push; };

void main() {
  uint32_t row = item_index();
  if (row >= push.count) return;
  uint32_t along = uint32_t(push.bricks.x), base = row * along;
  uint32_t begin = 0u;   // of the run
  for (uint32_t k = 0u; k <= along; ++k) {
    if (k < along && brick_slot[base + k] >= kBrickInternal) continue;
    uint32_t node = begin == 0u || k == along ? 0u : 1u + base + begin;
    for (uint32_t i = begin; i < k; ++i) parent[1u + base + i] = node;
    begin = k + 1u;
  }
}
