// One invocation: one pair of triangles with their corners' numbers. Reads cases, writes whether they touch along a seam.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/seam.glsl"
#include "tests/compute/shaders/probe_geometry.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { SeamCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { SeamAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  SeamCase c = cases[i];
  Triangle s = Triangle(c.s[0], c.s[1], c.s[2]), t = Triangle(c.t[0], c.t[1], c.t[2]);
  answers[i] = SeamAnswer(touch_along_a_seam(s, t, c.of_s, c.of_t) ? 1 : 0, share_an_edge(c.of_s, c.of_t) ? 1 : 0,
                          meet_in_a_corner_alone(s, t, c.of_s, c.of_t) ? 1 : 0, triangles_meet(s, t) && !boxes_meet(s, t) ? 1 : 0);
}
