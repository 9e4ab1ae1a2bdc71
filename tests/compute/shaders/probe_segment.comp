// One invocation: one segment and one triangle. Reads cases, writes the sign of the perturbed crossing, and what
// floats say.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/lib/segment_estimate.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { RayCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { SegmentAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  RayCase c = cases[i];
  answers[i].crossing = segment_crossing(c.point, c.direction, c.corner[0], c.corner[1], c.corner[2]);
  answers[i].estimate = segment_estimate(c.point, c.direction, c.corner[0], c.corner[1], c.corner[2]);
}
