// One invocation: one point and one triangle. Reads cases, writes the distance, and between what
// bounds floats see it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/distance.glsl"
#include "shaders/lib/distance_estimate.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { DistanceCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { DistanceAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  DistanceCase c = cases[i];
  answers[i].steps = distance_at(height_above(c.normal, c.corner[0], c.point), c.normal, c.corner[0], c.corner[1], c.corner[2], c.point);
  const DistanceBounds bounds = distance_bounds(c.corner[0], c.corner[1], c.corner[2], c.normal, c.point);
  answers[i].least = int32_t(floor(bounds.least));
  answers[i].most = int32_t(ceil(bounds.most));
}
