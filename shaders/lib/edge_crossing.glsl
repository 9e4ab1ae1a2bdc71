// Where an edge of one triangle passes through another, docs/EXACTNESS.md section 7 (needles).
#ifndef PALPATE_LIB_EDGE_CROSSING
#define PALPATE_LIB_EDGE_CROSSING
#include "shaders/lib/wide_integer.glsl"

// Side on which the line through p along d passes the edge from u to v. Differences within 2^29 + 1.
int32_t line_side(ivec3 p, ivec3 d, ivec3 u, ivec3 v) { return sign_dot(raw_normal(p, u, v), d); }

// The point e of edge pq on the closed triangle abc, if their planes cross there in one point.
bool edge_crossing(ivec3 p, ivec3 q, ivec3 a, ivec3 b, ivec3 c, out ivec3 e) {
  e = p;
  // From the lexicographically smaller end, so that the rounding does not depend on who asks.
  if (q.x < p.x || (q.x == p.x && (q.y < p.y || (q.y == p.y && q.z < p.z)))) {
    const ivec3 r = p;
    p = q;
    q = r;
  }
  const i64vec3 n = raw_normal(a, b, c);
  const Split30 dp = split30_dot(n, p - a), dq = split30_dot(n, q - a);
  Split30 span = split30_sub(dp, dq);
  if (split30_is_zero(span) || split30_sign(dp) * split30_sign(dq) > 0) return false;
  const ivec3 d = q - p;
  const ivec3 sides = ivec3(line_side(p, d, a, b), line_side(p, d, b, c), line_side(p, d, c, a));
  if (any(lessThan(sides, ivec3(0))) && any(greaterThan(sides, ivec3(0)))) return false;
  // The ends are on different sides (or on the plane): d_p and d_p − d_q have one sign, and the ratio is in [0, 1].
  const Split30 part = split30_sign(span) < 0 ? split30_neg(dp) : dp;
  if (split30_sign(span) < 0) span = split30_neg(span);
  const int64_t ratio = int64_t(i128_ratio_q30(i128_of(part), i128_of(span)));
  e = p + ivec3((i64vec3(d) * ratio) >> 30);
  return true;
}
#endif
