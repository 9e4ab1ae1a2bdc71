// One invocation: one grid point of one triangle. Reads cases, writes the sample.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/sample.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { SampleCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { SampleAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  SampleCase c = cases[i];
  SampledTriangle t = SampledTriangle(c.corner[0], c.corner[1], c.corner[2], c.axis, raw_normal(c.corner[0], c.corner[1], c.corner[2]));
  ivec2 g = ivec2(c.u, c.v);
  bool inside = grid_point_inside(t, g);
  answers[i] = SampleAnswer(inside ? 1 : 0, inside ? sample_point(t, g) : ivec3(0));
}
