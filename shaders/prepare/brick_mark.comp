// One invocation: an item (triangle, brick). Marks the brick as mixed with a 1.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer ItemCell { uint32_t item_cell[]; };
layout(scalar, set = 0, binding = 1) buffer Marks { uint32_t marks[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t item = item_index();
  if (item < count) atomicMax(marks[item_cell[item]], 1u);
}
