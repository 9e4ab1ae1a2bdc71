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
  Split30 dot_ = split30_dot(n, c.d);
  Int128 wide = i128_of(dot_);
  Int128 product = i64_mul(c.x, c.y);
  WideAnswer a;
  a.sign_ = sign_dot(n, c.d);
  a.wide_sign = i128_sign(wide);
  a.less = i128_less(wide, product) ? 1 : 0;
  a.dot_high = wide.high;
  a.dot_low = wide.low;
  a.product_high = product.high;
  a.product_low = product.low;
  Int128 sum = i128_add(wide, product), difference = i128_sub(wide, product);
  a.sum_high = sum.high;
  a.sum_low = sum.low;
  a.difference_high = difference.high;
  a.difference_low = difference.low;
  i64vec3 normal = raw_normal(c.a, c.b, c.c);
  a.normal[0] = normal.x;
  a.normal[1] = normal.y;
  a.normal[2] = normal.z;
  // |n·d| over |n·d| + |x|, and two times the first over the second: both sides of 1.
  Int128 top = i128_sign(wide) < 0 ? i128_neg(wide) : wide;
  Int128 bottom = i128_add(top, i128(int64_t(uint64_t(c.x) >> 2) + 1l));
  a.ratio = i128_ratio_q30(top, bottom);
  a.ratio_two = i128_ratio_q30(i128_shift_left(top, 1), bottom);
  answers[i] = a;
}
