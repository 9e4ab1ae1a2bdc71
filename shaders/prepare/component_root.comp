// One invocation: a node. Replaces its parent by its root; INIT 1: makes it its own parent. A walk that is
// too long raises `again`, and the host runs all once more.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(constant_id = 0) const uint32_t INIT = 0u;

layout(scalar, set = 0, binding = 0) coherent buffer Parent { uint32_t parent[]; };
layout(scalar, set = 0, binding = 1) buffer Again { uint32_t again; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t node = item_index();
  if (node >= count) return;
  if (INIT != 0u) {
    parent[node] = node;
    return;
  }
  uint32_t root = parent[node];
  for (uint32_t k = 0u; k < kFindSteps; ++k) {
    uint32_t up = parent[root];
    if (up == root) break;
    root = up;
    if (k == kFindSteps - 1u) atomicMax(again, 1u);
  }
  atomicMin(parent[node], root);
}
