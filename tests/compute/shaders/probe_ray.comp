// One invocation: one ray and one triangle. Reads cases, writes the crossing.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/line_box.glsl"
#include "shaders/lib/ray.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { RayCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { RayAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  RayCase c = cases[i];
  Crossing crossing = ray_crossing(c.point, c.direction, c.corner[0], c.corner[1], c.corner[2]);
  vec3 e = ray_scaled(c.direction);
  ivec3 low = min(min(c.corner[0], c.corner[1]), c.corner[2]), high = max(max(c.corner[0], c.corner[1]), c.corner[2]);
  bool kept = ray_may_meet_triangle(c.point, e, c.corner[0], c.corner[1], c.corner[2]) && ray_may_meet_box(c.point, e, low, high);
  answers[i] = RayAnswer(crossing.sign, crossing.height, crossing.sign != 0 && !kept ? 1 : 0);
}
