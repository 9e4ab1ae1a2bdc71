// One invocation: one Case. Reads cases, writes answers of every function of lib/wide_integer.glsl.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/wide_integer.glsl"
#include "tests/compute/shaders/probe_wide_integer.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { WideCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { WideAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

void main() {
  uint32_t i = item_index();
  if (i >= count) return;
  WideCase c = cases[i];
  i64vec3 n = i64vec3(c.n[0], c.n[1], c.n[2]);
  Split30 one = split30_dot(n, c.d), two = split30_dot(n, c.e), sum = split30_add(one, two), difference = split30_sub(one, two);
  WideAnswer a;
  a.sign_ = sign_dot(n, c.d);
  a.negated_sign = split30_sign(split30_neg(one));
  a.is_zero = split30_is_zero(one) ? 1 : 0;
  a.number_sign = sign_of(c.n[0]);
  a.dot_high = one.high;
  a.dot_low = one.low;
  a.sum_high = sum.high;
  a.sum_low = sum.low;
  a.difference_high = difference.high;
  a.difference_low = difference.low;
  i64vec3 normal = raw_normal(c.a, c.b, c.c);
  a.normal[0] = normal.x;
  a.normal[1] = normal.y;
  a.normal[2] = normal.z;
  answers[i] = a;
}
