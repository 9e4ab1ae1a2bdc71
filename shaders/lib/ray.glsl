// Crossings of rays from lattice points with triangles, exact under the perturbation rule of
// docs/EXACTNESS.md section 1: of all triangles round an edge or a corner, just those that the perturbed ray
// meets are hit.
#ifndef PALPATE_RAY_GLSL
#define PALPATE_RAY_GLSL
#include "shaders/lib/wide_integer.glsl"

// Sign of the first component that is not 0, else 0.
int first_sign(i64vec3 v) {
  return v.x != 0l ? sign_of(v.x) : (v.y != 0l ? sign_of(v.y) : sign_of(v.z));
}

// Side on which the perturbed line from p along d passes the edge from u to v.
int edge_side(ivec3 p, ivec3 d, ivec3 u, ivec3 v) {
  const int side = sign_dot(raw_normal(p, u, v), d);
  return side != 0 ? side : first_sign(raw_normal(ivec3(0), d, v - u));
}

// floor(2^30 · n / m) for 0 ≤ n / m ≤ 2, 0 < m < 2^90. The estimate from the leading 31 bits of m is at most
// 3 off; the exact remainder n · 2^30 − q · m mends it.
uint32_t height_quotient(Split30 n, Split30 m) {
  const uint64_t lead = uint64_t(m.high != 0l ? m.high : m.low);
  const int bits = (m.high != 0l ? 31 : 1) +
                   ((lead >> 32) != 0ul ? 32 + findMSB(uint32_t(lead >> 32)) : findMSB(uint32_t(lead)));
  const int shift = max(bits - 31, 0);
  const int64_t n_top = shift >= 30 ? n.high >> (shift - 30) : (n.high << (30 - shift)) + (n.low >> shift);
  const int64_t m_top = shift >= 30 ? m.high >> (shift - 30) : (m.high << (30 - shift)) + (m.low >> shift);
  int64_t q = (n_top << 30) / m_top;   // n_top < 2^33

  // The remainder as high · 2^30 + low, from n · 2^30 = (n.high · 2^30 + n.low) · 2^30. q · m.low < 2^62;
  // high is computed modulo
  // 2^64 and its true value stays within 4 m / 2^30 < 2^62.
  const int64_t low_product = q * m.low;
  Split30 rest =
      split30_carry((n.high << 30) + n.low - q * m.high - (low_product >> 30), -(low_product & 0x3FFFFFFFl));
  for (int i = 0; i < 5 && rest.high < 0l; ++i) {
    rest = split30_add(rest, m);
    q -= 1l;
  }
  for (int i = 0; i < 5; ++i) {
    const Split30 less = split30_sub(rest, m);
    if (less.high < 0l) break;
    rest = less;
    q += 1l;
  }
  return uint32_t(q);
}

struct Crossing {
  int sign;      // +1 leaving through an outward face, −1 entering, 0 no crossing
  uint32_t height;   // floor(t · 2^30); the largest component of the direction is in [2^28, 2^29)
};

// The ray from p in direction d (|d| < 2^29, not 0) through triangle abc.
Crossing ray_crossing(ivec3 p, ivec3 d, ivec3 a, ivec3 b, ivec3 c) {
  const i64vec3 n = raw_normal(a, b, c);
  const Split30 slope = split30_dot(n, d);
  const int facing = split30_sign(slope);
  if (facing == 0) return Crossing(0, 0u);
  if (edge_side(p, d, a, b) != facing || edge_side(p, d, b, c) != facing || edge_side(p, d, c, a) != facing)
    return Crossing(0, 0u);
  const Split30 distance = split30_dot(n, a - p);
  const int side = split30_sign(distance);
  if (side == 0) return first_sign(n) == -facing ? Crossing(facing, 0u) : Crossing(0, 0u);
  if (side != facing) return Crossing(0, 0u);
  return Crossing(facing, facing > 0 ? height_quotient(distance, slope)
                                     : height_quotient(split30_neg(distance), split30_neg(slope)));
}

#endif
