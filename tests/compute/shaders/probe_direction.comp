// One invocation: one sum of normals. Reads cases, writes its direction.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/direction.glsl"
#include "tests/compute/shaders/probe_sums.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { DirectionCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { ivec3 answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  DirectionCase c = cases[i];
  i64vec3 sum = i64vec3(c.sum[0], c.sum[1], c.sum[2]);
  answers[i] = largest_component(sum) == 0l ? ivec3(0) : normalise(sum);
}
