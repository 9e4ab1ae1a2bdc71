// Exact arithmetic beyond 64 bits. Every bound that a caller must keep is written at the function.
#ifndef PALPATE_LIB_WIDE_INTEGER
#define PALPATE_LIB_WIDE_INTEGER
#include "shaders/shared/base.h"

// The product of two 32-bit integers.
int64_t mul_wide(int32_t a, int32_t b) { return int64_t(a) * int64_t(b); }

// (b − a) × (c − a). Differences within 2^29 + 1: each component within 2^59.2.
i64vec3 raw_normal(ivec3 a, ivec3 b, ivec3 c) {
  i64vec3 u = i64vec3(b - a), v = i64vec3(c - a);
  return i64vec3(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
}

// A value of up to 2^93 as high · 2^30 + low, 0 ≤ low < 2^30: the sum of products of 32-bit and 60-bit
// integers.
struct Split30 {
  int64_t high;
  int64_t low;
};

Split30 split30_carry(int64_t high, int64_t low) { return Split30(high + (low >> 30), low & 0x3FFFFFFFl); }

// n·d, |n_i| < 2^61, |d_i| ≤ 2^30: each sum is within 3·2^61 < 2^63. The high parts fit 32 bits: products of
// widened 32-bit integers are one instruction where those of 64-bit ones are eight.
Split30 split30_dot(i64vec3 n, ivec3 d) {
  i64vec3 w = i64vec3(d);
  i64vec3 h = i64vec3(ivec3(n >> 30));
  i64vec3 l = n & 0x3FFFFFFFl;
  return split30_carry(h.x * w.x + h.y * w.y + h.z * w.z, l.x * w.x + l.y * w.y + l.z * w.z);
}

Split30 split30_sub(Split30 a, Split30 b) { return split30_carry(a.high - b.high, a.low - b.low); }
Split30 split30_add(Split30 a, Split30 b) { return split30_carry(a.high + b.high, a.low + b.low); }
Split30 split30_neg(Split30 a) { return split30_carry(-a.high, -a.low); }
bool split30_is_zero(Split30 a) { return a.high == 0l && a.low == 0l; }

// −1, 0 or +1.
int32_t split30_sign(Split30 a) { return a.high < 0l ? -1 : (a.high > 0l || a.low > 0l ? 1 : 0); }

// Sign of n·d under the bounds of split30_dot.
int32_t sign_dot(i64vec3 n, ivec3 d) { return split30_sign(split30_dot(n, d)); }

int32_t sign_of(int64_t v) { return v < 0l ? -1 : (v > 0l ? 1 : 0); }
#endif
