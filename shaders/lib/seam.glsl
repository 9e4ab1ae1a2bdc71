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

// Common corners of two triangles by their vertex numbers: how many, and the place of the last in each.
ivec3 common_corners(uvec3 of_s, uvec3 of_t) {
  ivec3 found = ivec3(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (of_s[i] == of_t[j]) found = ivec3(found.x + 1, i, j);
  return found;
}

bool share_an_edge(uvec3 of_s, uvec3 of_t) { return common_corners(of_s, of_t).x > 1; }

// False for triangles that share an edge.
bool touch_along_a_seam(Triangle s, Triangle t, uvec3 of_s, uvec3 of_t) {
  ivec3 corners = common_corners(of_s, of_t);
  if (corners.x > 1) return false;
  if (corners.x == 0) return triangles_meet(s, t);
  return segment_meets(corner_of(s, (corners.y + 1) % 3), corner_of(s, (corners.y + 2) % 3), t) ||
         segment_meets(corner_of(t, (corners.z + 1) % 3), corner_of(t, (corners.z + 2) % 3), s);
}

// A cheap proof that two triangles with one common corner meet nowhere else: a plane through it has the rest of s on one
// side (touching allowed) and the rest of t strictly on the other. Floats propose the plane's normal, integers decide.
bool meet_in_a_corner_alone(Triangle s, Triangle t, uvec3 of_s, uvec3 of_t) {
  ivec3 corners = common_corners(of_s, of_t);
  if (corners.x != 1) return false;
  ivec3 c = corner_of(s, corners.y);
  ivec3 s1 = corner_of(s, (corners.y + 1) % 3) - c, s2 = corner_of(s, (corners.y + 2) % 3) - c;
  ivec3 t1 = corner_of(t, (corners.z + 1) % 3) - c, t2 = corner_of(t, (corners.z + 2) % 3) - c;
  vec3 towards_s = normalize(vec3(s1)) + normalize(vec3(s2)) - normalize(vec3(t1)) - normalize(vec3(t2));   // within 4
  i64vec3 m = i64vec3(ivec3(towards_s * 67108864.0));   // within 2^28; a product with 2^29 fits easily
  i64vec3 p1 = m * i64vec3(s1), p2 = m * i64vec3(s2), q1 = m * i64vec3(t1), q2 = m * i64vec3(t2);
  return p1.x + p1.y + p1.z >= 0l && p2.x + p2.y + p2.z >= 0l && q1.x + q1.y + q1.z < 0l && q2.x + q2.y + q2.z < 0l;
}
#endif
