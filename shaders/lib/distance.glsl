// The distance between a lattice point and a triangle (docs/EXACTNESS.md section 4, "Distance"), exact. There
// are no loops here: they would count against what llvmpipe lets an invocation run, triangle by triangle.
#ifndef PALPATE_LIB_DISTANCE
#define PALPATE_LIB_DISTANCE
#include "shaders/shared/frame_field.h"
#include "shaders/lib/direction.glsl"
#include "shaders/lib/wide_integer.glsl"

int64_t wide_dot(ivec3 a, ivec3 b) { return mul_wide(a.x, b.x) + mul_wide(a.y, b.y) + mul_wide(a.z, b.z); }

// floor(√v), 0 ≤ v < 2^62. A float's root is off by less than 2^10; what is left of v says by how much, to
// less than one.
int32_t floor_root(int64_t v) {
  int64_t r = int64_t(sqrt(float(v)));
  if (r > 0l) r += int64_t(floor(float(v - r * r) / (2.0 * float(r))));
  if (r * r > v) r -= 1l;
  if (r * r > v) r -= 1l;
  if ((r + 1l) * (r + 1l) <= v) r += 1l;
  if ((r + 1l) * (r + 1l) <= v) r += 1l;
  return int32_t(r);
}

// floor(a / b), 2^28 ≤ b < 2^30, the quotient within 2^30: in two steps as above.
int32_t floor_quotient(int64_t a, int32_t b) {
  const int64_t wide = int64_t(b);
  const float one = 1.0 / float(b);
  int64_t q = int64_t(float(a) * one);
  q += int64_t(floor(float(a - q * wide) * one));
  if (q * wide > a) q -= 1l;
  if (q * wide > a) q -= 1l;
  if ((q + 1l) * wide <= a) q += 1l;
  if ((q + 1l) * wide <= a) q += 1l;
  return int32_t(q);
}

// How far p lies from the plane through a with the unit normal n (Q30). |n·(p − a)| within 3 · 2^59.
int32_t height_above(ivec3 n, ivec3 a, ivec3 p) {
  return int32_t(abs((wide_dot(n, p - a) + (1l << 29)) >> 30));
}

// The squared distance by way of the edge from u to v, if the point lies on its outer side; the least of them
// so far, −1: none.
void pass_edge(ivec3 u, ivec3 v, ivec3 p, ivec3 n, int32_t height, inout int64_t least) {
  const ivec3 edge = v - u, from = p - u;
  const ivec3 along = normalise(i64vec3(edge));   // within 2^29
  const ivec3 across = ivec3(i64vec3(mul_wide(along.y, n.z) - mul_wide(along.z, n.y),
                                     mul_wide(along.z, n.x) - mul_wide(along.x, n.z),
                                     mul_wide(along.x, n.y) - mul_wide(along.y, n.x)) >>
                             30);
  const int32_t size = floor_root(wide_dot(along, along));   // from 2^28 on
  const int32_t side = floor_quotient(wide_dot(across, from), size);
  if (side <= 0) return;
  const int32_t at = floor_quotient(wide_dot(along, from), size);
  const int32_t over = max(0, max(-at, at - floor_root(wide_dot(edge, edge))));
  // Within 3 · 2^60.
  const int64_t squared = mul_wide(height, height) + mul_wide(side, side) + mul_wide(over, over);
  if (least == -1l || squared < least) least = squared;
}

// From p, `height` above the plane of abc. Neither collapsed; differences within 2^29 + 1.
int32_t distance_at(int32_t height, ivec3 n, ivec3 a, ivec3 b, ivec3 c, ivec3 p) {
  int64_t least = -1l;
  pass_edge(a, b, p, n, height, least);
  pass_edge(b, c, p, n, height, least);
  pass_edge(c, a, p, n, height, least);
  if (least != -1l) return floor_root(least);
  // Beyond the end of a needle thinner than a step no side is above 0.
  const ivec3 gap = max(max(min(min(a, b), c) - p, p - max(max(a, b), c)), ivec3(0));
  const int32_t to_box = floor_root(wide_dot(gap, gap));
  return to_box > height + kDepthSlack ? to_box : height;
}

// From p to the nearest point of the edge from u to v.
ivec3 way_to_edge(ivec3 u, ivec3 v, ivec3 p) {
  const ivec3 edge = v - u, from = p - u, along = normalise(i64vec3(edge));
  const int32_t size = floor_root(wide_dot(along, along));
  const int32_t at = clamp(floor_quotient(wide_dot(along, from), size), 0, floor_root(wide_dot(edge, edge)));
  return ivec3(floor_quotient(mul_wide(along.x, at), size), floor_quotient(mul_wide(along.y, at), size),
               floor_quotient(mul_wide(along.z, at), size)) -
         from;
}

// The unit way from p to the nearest point of abc, which is `steps` away, Q30 (section 4, "Way out").
ivec3 way_out(uint32_t steps, ivec3 n, ivec3 a, ivec3 b, ivec3 c, ivec3 p) {
  const int32_t above = int32_t((wide_dot(n, p - a) + (1l << 29)) >> 30), height = abs(above);
  int64_t least = -1l;
  pass_edge(a, b, p, n, height, least);
  ivec3 u = a, v = b;
  int64_t before = least;
  pass_edge(b, c, p, n, height, least);
  if (least != before) {
    u = b;
    v = c;
  }
  before = least;
  pass_edge(c, a, p, n, height, least);
  if (least != before) {
    u = c;
    v = a;
  }
  if (steps < kLeastWay) return n;
  if (least == -1l) return above > 0 ? -n : n;
  const ivec3 way = normalise(i64vec3(way_to_edge(u, v, p)));
  const int32_t size = floor_root(wide_dot(way, way));
  return ivec3(floor_quotient(int64_t(way.x) << 30, size), floor_quotient(int64_t(way.y) << 30, size),
               floor_quotient(int64_t(way.z) << 30, size));
}
#endif
