// Does a closed triangle touch a closed box? Exact, by separating axes, in integers.
#ifndef PALPATE_LIB_TRIANGLE_VOXEL
#define PALPATE_LIB_TRIANGLE_VOXEL
#include "shaders/lib/wide_integer.glsl"

// One of the nine axes (unit vector × edge): s and t are the projections of the edge and of the third corner.
bool separates(int64_t s, int64_t t, int64_t radius) { return min(s, t) > radius || max(s, t) < -radius; }

// The three axes of edge f, from corner p (an end of f) and corner q (the one opposite), relative to the
// box's centre and doubled like its extents e. |p|, |q| ≤ 2^30, |e| ≤ 2^30, |f| ≤ 2^29 + 1: every term within
// 2^60.
bool edge_separates(ivec3 f, ivec3 p, ivec3 q, ivec3 e) {
  ivec3 g = abs(f);
  return separates(mul_wide(p.z, f.y) - mul_wide(p.y, f.z), mul_wide(q.z, f.y) - mul_wide(q.y, f.z),
                   mul_wide(e.y, g.z) + mul_wide(e.z, g.y)) ||
         separates(mul_wide(p.x, f.z) - mul_wide(p.z, f.x), mul_wide(q.x, f.z) - mul_wide(q.z, f.x),
                   mul_wide(e.z, g.x) + mul_wide(e.x, g.z)) ||
         separates(mul_wide(p.y, f.x) - mul_wide(p.x, f.y), mul_wide(q.y, f.x) - mul_wide(q.x, f.y),
                   mul_wide(e.x, g.y) + mul_wide(e.y, g.x));
}

// Triangle abc (n its raw normal, not 0) and box [lo, hi]. Corners and box within ±2^28 and a few voxels
// more, so that
// 2a − lo − hi is within 2^30.
bool triangle_touches_box(ivec3 a, ivec3 b, ivec3 c, i64vec3 n, ivec3 lo, ivec3 hi) {
  ivec3 centre = lo + hi, e = hi - lo;
  ivec3 p = 2 * a - centre, q = 2 * b - centre, r = 2 * c - centre;
  // The box's faces.
  if (any(greaterThan(min(p, min(q, r)), e)) || any(lessThan(max(p, max(q, r)), -e))) return false;
  // The triangle's plane: |n·p| ≤ |n|·e. Both sides need 92 bits.
  Split30 distance = split30_dot(n, p);
  if (split30_sign(distance) < 0) distance = split30_neg(distance);
  if (split30_sign(split30_sub(split30_dot(abs(n), e), distance)) < 0) return false;
  return !edge_separates(b - a, p, r, e) && !edge_separates(c - b, q, p, e) &&
         !edge_separates(a - c, r, q, e);
}
#endif
