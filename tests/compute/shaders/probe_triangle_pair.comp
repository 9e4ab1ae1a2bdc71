// One invocation: one pair of triangles. Reads cases, writes whether they meet.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/triangle_pair.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { PairCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { int32_t answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  PairCase c = cases[i];
  answers[i] = triangles_meet(Triangle(c.s[0], c.s[1], c.s[2]), Triangle(c.t[0], c.t[1], c.t[2])) ? 1 : 0;
}
