// One invocation: one point and one triangle. Reads cases, writes the distance.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/distance.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { DistanceCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { int32_t answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  DistanceCase c = cases[i];
  answers[i] = distance_at(height_above(c.normal, c.corner[0], c.point), c.normal, c.corner[0], c.corner[1], c.corner[2], c.point);
}
