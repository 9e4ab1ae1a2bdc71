// The grid samples of a triangle (docs/EXACTNESS.md section 4), exact.
#ifndef PALPATE_SAMPLE_GLSL
#define PALPATE_SAMPLE_GLSL
#include "shaders/lib/wide_integer.glsl"
#include "shaders/shared/frame_field.h"

struct SampledTriangle {
  ivec3 a, b, c;
  int axis;        // k = sample_axis; u = k + 1, v = k + 2, modulo 3
  i64vec3 normal;  // raw, N_k ≠ 0
};

// Side of the edge from p to q on which the grid point g, moved by (ε, ε²), lies. Differences within 2^29 +
// 1.
int grid_side(ivec2 p, ivec2 q, ivec2 g) {
  const int side = sign_of(mul_wide(q.x - p.x, g.y - p.y) - mul_wide(q.y - p.y, g.x - p.x));
  if (side != 0) return side;
  return q.y != p.y ? sign(p.y - q.y) : sign(q.x - p.x);
}

ivec2 seen_along(int axis, ivec3 p) {
  return axis == 0 ? p.yz : (axis == 1 ? p.zx : p.xy);
}

// 2^32 times the fractional part of n times the golden ratio.
uint32_t golden(int32_t n) {
  return uint32_t(n) * 2654435769u;
}

// The sample of cell ij, as (u, v).
ivec2 sample_of_cell(ivec2 ij, int32_t spacing) {
  uint32_t moved_u, moved_v, low;
  umulExtended(golden(ij.y), uint32_t(spacing), moved_u, low);
  umulExtended(golden(ij.x), uint32_t(spacing), moved_v, low);
  return spacing * ij + ivec2(moved_u, moved_v);
}

// The cell that holds (u, v).
ivec2 cell_of_sample(ivec2 g, int32_t spacing) {
  const ivec2 q = g / spacing;
  return q - ivec2(greaterThan(q * spacing, g));
}

// The last level that the sample of cell ij is of, at most kMostSampleLevel.
uint32_t level_of_cell(ivec2 ij) {
  for (uint32_t level = 0u; level < kMostSampleLevel; level += 2u) {
    const ivec2 block = ij >> 1, within = ij & 1;
    const ivec2 stands = ivec2(golden(block.y) >> 31, golden(block.x) >> 31);
    if (all(notEqual(within, stands))) return level + 1u;
    if (any(notEqual(within, stands))) return level;
    ij = block;
  }
  return kMostSampleLevel;
}

// Whether the triangle has a sample at g = (u, v).
bool grid_point_inside(SampledTriangle t, ivec2 g) {
  const ivec2 a = seen_along(t.axis, t.a), b = seen_along(t.axis, t.b), c = seen_along(t.axis, t.c);
  const int facing = sign_of(t.normal[t.axis]);
  return grid_side(a, b, g) == facing && grid_side(b, c, g) == facing && grid_side(c, a, g) == facing;
}

// floor(a_k − (N_u (g_u − a_u) + N_v (g_v − a_v)) / N_k), for g in the triangle's box.
// |N_u|, |N_v| ≤ |N_k| < 2^60 and |g − a| ≤ 2^29 + 1. The estimate from the leading 31 bits of N_k is at most
// 4 off, so that the exact remainder is within 5 · 2^59.2 and may be computed modulo 2^64.
// Bit by bit: here NVIDIA's compiler (driver 580) fails on a division of 64-bit integers, and on float quotients
// of them. Loops of fixed lengths, which llvmpipe rolls out (lib/budget.glsl; equivalence case
// many_samples_of_a_voxel).
int32_t height_on_triangle(SampledTriangle t, ivec2 g) {
  const ivec2 d = g - seen_along(t.axis, t.a);
  const int64_t nk = t.normal[t.axis];
  int64_t nu = t.normal[(t.axis + 1) % 3], nv = t.normal[(t.axis + 2) % 3];
  const int64_t m = abs(nk);
  if (nk > 0l) {
    nu = -nu;
    nv = -nv;
  }
  const uint32_t top = uint32_t(m >> 31);
  const int shift = top != 0u ? findMSB(top) + 1 : 0;
  const int64_t leading = m >> shift;
  int64_t left = (nu >> shift) * int64_t(d.x) + (nv >> shift) * int64_t(d.y);
  int32_t q = 0;
  const bool below = left < 0l;
  left = below ? -left : left;
  for (int bit = 30; bit >= 0; --bit)
    if (left >= leading << bit) {
      left -= leading << bit;
      q += 1 << bit;
    }
  q = below ? -q : q;
  int64_t rest = nu * int64_t(d.x) + nv * int64_t(d.y) - int64_t(q) * m;
  for (int i = 0; i < 8; ++i)
    if (rest < 0l) {
      rest += m;
      q -= 1;
    }
  for (int i = 0; i < 8; ++i)
    if (rest >= m) {
      rest -= m;
      q += 1;
    }
  return t.a[t.axis] + q;
}

// The sample at g.
ivec3 sample_point(SampledTriangle t, ivec2 g) {
  const int32_t h = height_on_triangle(t, g);
  return t.axis == 0 ? ivec3(h, g.x, g.y) : (t.axis == 1 ? ivec3(g.y, h, g.x) : ivec3(g.x, g.y, h));
}
#endif
