// Whether two closed triangles share a point, exactly: coplanar overlap and touching count. Neither may be
// collapsed.
#ifndef PALPATE_TRIANGLE_PAIR_GLSL
#define PALPATE_TRIANGLE_PAIR_GLSL
#include "shaders/lib/wide_integer.glsl"

// Sign of (b − a) × (c − a) · (d − a): > 0 when d lies on the side to which abc, seen counter-clockwise,
// faces.
int orientation(ivec3 a, ivec3 b, ivec3 c, ivec3 d) {
  return sign_dot(raw_normal(a, b, c), d - a);
}

// Axis of the largest |component|; ties: the lowest.
int largest_axis(i64vec3 v) {
  const i64vec3 m = abs(v);
  const int xy = m.y > m.x ? 1 : 0;
  return m.z > m[xy] ? 2 : xy;
}

struct Triangle {
  ivec3 a, b, c;
};

ivec3 corner_of(Triangle t, int k) {
  return k == 0 ? t.a : (k == 1 ? t.b : t.c);
}

// Sides of t's corners of the plane through p with normal n.
ivec3 plane_sides(i64vec3 n, ivec3 p, Triangle t) {
  return ivec3(sign_dot(n, t.a - p), sign_dot(n, t.b - p), sign_dot(n, t.c - p));
}

bool one_sided(ivec3 sides) {
  return all(greaterThan(sides, ivec3(0))) || all(lessThan(sides, ivec3(0)));
}

// Doubled signed area of uvw seen along axis k; within 2^60.
int64_t area_along(int k, ivec3 u, ivec3 v, ivec3 w) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  return int64_t(v[i] - u[i]) * int64_t(w[j] - u[j]) - int64_t(v[j] - u[j]) * int64_t(w[i] - u[i]);
}

// Whether an edge of s has all of t strictly on its outer side, in the projection along k where s turns as
// `turn`.
bool edge_separates(Triangle s, Triangle t, int k, int turn) {
  bool apart = false;
  for (int e = 0; e < 3; ++e) {
    const ivec3 u = corner_of(s, e), v = corner_of(s, (e + 1) % 3);
    const ivec3 sides = turn * ivec3(sign_of(area_along(k, u, v, t.a)), sign_of(area_along(k, u, v, t.b)),
                                     sign_of(area_along(k, u, v, t.c)));
    apart = apart || all(lessThan(sides, ivec3(0)));
  }
  return apart;
}

// Convex sets in a plane are disjoint exactly when a line along an edge of one of them separates them
// strictly.
bool coplanar_triangles_meet(Triangle s, Triangle t, i64vec3 n) {
  const int k = largest_axis(n);
  const int s_turn = sign_of(area_along(k, s.a, s.b, s.c)), t_turn = sign_of(area_along(k, t.a, t.b, t.c));
  return !edge_separates(s, t, k, s_turn) && !edge_separates(t, s, k, t_turn);
}

bool same_side(ivec3 sides) {
  return all(greaterThanEqual(sides, ivec3(0))) || all(lessThanEqual(sides, ivec3(0)));
}

// An edge whose ends lie on different sides of the other's plane (touching allowed, not both) meets the other
// triangle exactly when the edge's line passes its three edges on one side. `line` are those three
// orientations.
bool edge_meets(int from, int to, ivec3 line) {
  return from * to <= 0 && (from != 0 || to != 0) && same_side(line);
}

// Two triangles in different planes meet exactly when an edge of one meets the other at a single point; edges
// that lie in the other's plane need no look of their own, because their ends and what crosses them belong to
// edges that do not.
bool triangles_meet(Triangle s, Triangle t) {
  const i64vec3 t_normal = raw_normal(t.a, t.b, t.c);
  const ivec3 s_sides = plane_sides(t_normal, t.a, s);
  if (one_sided(s_sides)) return false;
  const i64vec3 s_normal = raw_normal(s.a, s.b, s.c);
  const ivec3 t_sides = plane_sides(s_normal, s.a, t);
  if (one_sided(t_sides)) return false;
  if (s_sides == ivec3(0)) return coplanar_triangles_meet(s, t, t_normal);

  ivec3 lines[3];   // lines[i][j]: how edge i of s passes edge j of t; the same number the other way round
  for (int i = 0; i < 3; ++i) {
    const ivec3 p = corner_of(s, i), q = corner_of(s, (i + 1) % 3);
    lines[i] = ivec3(orientation(p, q, t.a, t.b), orientation(p, q, t.b, t.c), orientation(p, q, t.c, t.a));
  }
  return edge_meets(s_sides.x, s_sides.y, lines[0]) || edge_meets(s_sides.y, s_sides.z, lines[1]) ||
         edge_meets(s_sides.z, s_sides.x, lines[2]) ||
         edge_meets(t_sides.x, t_sides.y, ivec3(lines[0].x, lines[1].x, lines[2].x)) ||
         edge_meets(t_sides.y, t_sides.z, ivec3(lines[0].y, lines[1].y, lines[2].y)) ||
         edge_meets(t_sides.z, t_sides.x, ivec3(lines[0].z, lines[1].z, lines[2].z));
}

#endif
