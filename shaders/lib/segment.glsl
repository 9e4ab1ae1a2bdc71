// Crossings of segments between lattice points with triangles, under the perturbation of docs/EXACTNESS.md
// section 1: both ends are moved alike, so that neither lies on a triangle, and a path's crossings add up to
// the difference of the windings at its ends.
#ifndef PALPATE_SEGMENT_GLSL
#define PALPATE_SEGMENT_GLSL
#include "shaders/lib/ray.glsl"

// Side of the plane of abc, normal n, on which it lies ahead of the perturbed p.
int plane_ahead(i64vec3 n, ivec3 p, ivec3 a) {
  const int side = sign_dot(n, a - p);
  return side != 0 ? side : -first_sign(n);
}

// +1 when the way from p to q, p ≠ q, leaves through the outward face of abc, −1 when it enters, 0 when it
// does not cross.
int segment_crossing(ivec3 p, ivec3 q, ivec3 a, ivec3 b, ivec3 c) {
  const i64vec3 n = raw_normal(a, b, c);
  if (n == i64vec3(0l)) return 0;
  const int facing = plane_ahead(n, p, a);
  if (plane_ahead(n, q, a) == facing) return 0;   // both ends on one side
  const ivec3 d = q - p;
  return edge_side(p, d, a, b) == facing && edge_side(p, d, b, c) == facing && edge_side(p, d, c, a) == facing
             ? facing
             : 0;
}
#endif
