// Whether two triangles that share no edge touch in more than one common corner (docs/EXACTNESS.md section 5). Exact.
#ifndef PALPATE_LIB_SEAM
#define PALPATE_LIB_SEAM
#include "shaders/lib/triangle_pair.glsl"

// Whether closed segment pq, p ≠ q, meets closed triangle t.
bool segment_meets(ivec3 p, ivec3 q, Triangle t) {
  i64vec3 n = raw_normal(t.a, t.b, t.c);
  int of_p = sign_dot(n, p - t.a), of_q = sign_dot(n, q - t.a);
  if (of_p * of_q > 0) return false;
  if (of_p != 0 || of_q != 0) return same_side(ivec3(orientation(p, q, t.a, t.b), orientation(p, q, t.b, t.c), orientation(p, q, t.c, t.a)));
  // In one plane: apart exactly when the segment's line, or that of an edge, separates them strictly.
  int k = largest_axis(n), turn = sign_of(area_along(k, t.a, t.b, t.c));
  if (one_sided(ivec3(sign_of(area_along(k, p, q, t.a)), sign_of(area_along(k, p, q, t.b)), sign_of(area_along(k, p, q, t.c))))) return false;
  for (int e = 0; e < 3; ++e) {
    ivec3 u = corner_of(t, e), v = corner_of(t, (e + 1) % 3);
    if (turn * sign_of(area_along(k, u, v, p)) < 0 && turn * sign_of(area_along(k, u, v, q)) < 0) return false;
  }
  return true;
}

// `of_s`, `of_t`: vertex numbers of s and t, which tell shared corners. False for triangles that share an edge.
bool touch_along_a_seam(Triangle s, Triangle t, uvec3 of_s, uvec3 of_t) {
  int corners = 0, at_s = 0, at_t = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (of_s[i] == of_t[j]) {
        ++corners;
        at_s = i;
        at_t = j;
      }
  if (corners > 1) return false;
  if (corners == 0) return triangles_meet(s, t);
  return segment_meets(corner_of(s, (at_s + 1) % 3), corner_of(s, (at_s + 2) % 3), t) ||
         segment_meets(corner_of(t, (at_t + 1) % 3), corner_of(t, (at_t + 2) % 3), s);
}
#endif
