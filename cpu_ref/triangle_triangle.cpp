#include "cpu_ref/triangle_triangle.h"

#include <algorithm>

namespace palpate::cpu_ref {
namespace {

struct Point2 {
  std::int64_t u = 0, v = 0;
};

/// Sign of the area of pqr. Differences within 2^29: products within 2^58, their difference within 2^59.
int turn(const Point2& p, const Point2& q, const Point2& r) {
  const std::int64_t area = (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
  return (area > 0) - (area < 0);
}

/// Whether r, known to be collinear with pq, lies between them.
bool between(const Point2& p, const Point2& q, const Point2& r) {
  return std::min(p.u, q.u) <= r.u && r.u <= std::max(p.u, q.u) && std::min(p.v, q.v) <= r.v &&
         r.v <= std::max(p.v, q.v);
}

bool segments_meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const int abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) || (cda == 0 && between(c, d, a)) ||
         (cdb == 0 && between(c, d, b));
}

bool point_in_triangle(const Point2& p, const std::array<Point2, 3>& t) {
  const int s0 = turn(t[0], t[1], p), s1 = turn(t[1], t[2], p), s2 = turn(t[2], t[0], p);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// A segment in the triangle's plane: dropping an axis along which N is not 0 keeps what meets what.
bool coplanar_segment_meets_triangle(const Int3& p, const Int3& q, const Triangle& triangle) {
  const int k = triangle.normal.x != 0 ? 0 : triangle.normal.y != 0 ? 1 : 2;
  const auto project = [k](const Int3& r) { return Point2{r[(k + 1) % 3], r[(k + 2) % 3]}; };
  const std::array<Point2, 3> t{project(triangle[0]), project(triangle[1]), project(triangle[2])};
  const Point2 p2 = project(p), q2 = project(q);
  return point_in_triangle(p2, t) || segments_meet(p2, q2, t[0], t[1]) || segments_meet(p2, q2, t[1], t[2]) ||
         segments_meet(p2, q2, t[2], t[0]);
}

/// Whether all corners of t lie strictly on one side of the plane of s.
bool on_one_side(const Triangle& s, const Triangle& t) {
  const int side = sign(s.side(t[0]));
  return side != 0 && sign(s.side(t[1])) == side && sign(s.side(t[2])) == side;
}

}  // namespace

bool segment_meets_triangle(const Int3& p, const Int3& q, const Triangle& triangle) {
  const int side_p = sign(triangle.side(p)), side_q = sign(triangle.side(q));
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return coplanar_segment_meets_triangle(p, q, triangle);
  // The segment has one point in the plane. It is in the triangle when the line pq passes all three edges on
  // the same side. D·((u − p) × (v − p)): within 2^29 · 2^59.2 · 3.
  const Long3 direction = difference(q, p);
  bool left = false, right = false;
  for (int k = 0; k < 3; ++k) {
    const Long3 u = difference(triangle[k], p), v = difference(triangle[(k + 1) % 3], p);
    const int side = sign(dot(direction, cross(u, v)));
    left = left || side > 0;
    right = right || side < 0;
  }
  return !(left && right);
}

bool triangles_intersect(const Triangle& s, const Triangle& t) {
  if (!s.box().meets(t.box()) || on_one_side(s, t) || on_one_side(t, s)) return false;
  // Two triangles that share a point share one that lies on an edge of either: the ends of their common
  // segment are, and of a common polygon the corners are.
  for (int k = 0; k < 3; ++k) {
    if (segment_meets_triangle(s[k], s[(k + 1) % 3], t)) return true;
    if (segment_meets_triangle(t[k], t[(k + 1) % 3], s)) return true;
  }
  return false;
}

}  // namespace palpate::cpu_ref
