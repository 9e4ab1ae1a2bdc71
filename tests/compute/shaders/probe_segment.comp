// One invocation: one segment and one triangle. Reads cases, writes the sign of the perturbed crossing.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/segment.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { RayCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { int32_t answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  RayCase c = cases[i];
  answers[i] = segment_crossing(c.point, c.direction, c.corner[0], c.corner[1], c.corner[2]);
}
