// One invocation: one BoxCase. Writes 1 if the triangle touches the box, else 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "tests/compute/shaders/probe_triangle_voxel.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { BoxCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { int32_t answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  BoxCase c = cases[i];
  answers[i] = triangle_touches_box(c.a, c.b, c.c, raw_normal(c.a, c.b, c.c), c.lo, c.hi) ? 1 : 0;
}
