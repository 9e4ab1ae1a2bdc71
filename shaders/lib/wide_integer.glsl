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

// A value of up to 2^93 as high · 2^30 + low, 0 ≤ low < 2^30: the sum of products of 32-bit and 60-bit integers.
struct Split30 {
  int64_t high;
  int64_t low;
};

Split30 split30_carry(int64_t high, int64_t low) { return Split30(high + (low >> 30), low & 0x3FFFFFFFl); }

// n·d, |n_i| < 2^61, |d_i| ≤ 2^30: each sum is within 3·2^61 < 2^63. The high parts fit 32 bits: products of widened 32-bit integers
// are one instruction where those of 64-bit ones are eight.
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

// A signed 128-bit integer in two's complement: high · 2^64 + low.
struct Int128 {
  int64_t high;
  uint64_t low;
};

Int128 i128(int64_t v) { return Int128(v >> 63, uint64_t(v)); }

Int128 i128_add(Int128 a, Int128 b) {
  uint64_t low = a.low + b.low;
  return Int128(a.high + b.high + (low < a.low ? 1l : 0l), low);
}

Int128 i128_neg(Int128 a) {
  uint64_t low = ~a.low + 1ul;
  return Int128(~a.high + (low == 0ul ? 1l : 0l), low);
}

Int128 i128_sub(Int128 a, Int128 b) {
  return Int128(a.high - b.high - (a.low < b.low ? 1l : 0l), a.low - b.low);
}

int32_t i128_sign(Int128 a) { return a.high < 0l ? -1 : ((a.high | int64_t(a.low)) == 0l ? 0 : 1); }

bool i128_less(Int128 a, Int128 b) { return a.high < b.high || (a.high == b.high && a.low < b.low); }
bool i128_equal(Int128 a, Int128 b) { return a.high == b.high && a.low == b.low; }

// The whole 128-bit product of two unsigned 64-bit integers, from 32-bit halves.
Int128 u64_mul(uint64_t a, uint64_t b) {
  uint64_t al = a & 0xFFFFFFFFul, ah = a >> 32, bl = b & 0xFFFFFFFFul, bh = b >> 32;
  uint64_t ll = al * bl, lh = al * bh, hl = ah * bl, hh = ah * bh;
  uint64_t middle = (ll >> 32) + (lh & 0xFFFFFFFFul) + (hl & 0xFFFFFFFFul);   // < 3 · 2^32
  return Int128(int64_t(hh + (lh >> 32) + (hl >> 32) + (middle >> 32)), (ll & 0xFFFFFFFFul) | middle << 32);
}

// The product of two signed 64-bit integers. Masks, not comparisons: Mesa 22.3 takes `int64_t(x) < 0` of a 32-bit x for false
// (seen on llvmpipe; tests/compute, ASheetFacesTheToolsCentreOfMass).
Int128 i64_mul(int64_t a, int64_t b) {
  Int128 p = u64_mul(uint64_t(a), uint64_t(b));
  // a read as unsigned is a + 2^64 when negative: take b · 2^64 off again, and the other way round.
  p.high -= ((a >> 63) & b) + ((b >> 63) & a);
  return p;
}

// high · 2^30 + low as 128 bits.
Int128 i128_of(Split30 a) {
  return i128_add(Int128(a.high >> 34, uint64_t(a.high) << 30), Int128(0l, uint64_t(a.low)));
}

// a << count, 0 ≤ count < 64; the result must fit.
Int128 i128_shift_left(Int128 a, int32_t count) {
  if (count == 0) return a;
  return Int128(a.high << count | int64_t(a.low >> (64 - count)), a.low << count);
}

// floor(numerator · 2^30 / denominator), 0 ≤ numerator < 2^95, 0 < denominator < 2^95, quotient < 2^33.
// Restoring division, one bit a step; nothing in it exceeds 98 bits.
uint64_t i128_ratio_q30(Int128 numerator, Int128 denominator) {
  // The whole part first; it is below 8.
  uint64_t quotient = 0ul;
  Int128 rest = numerator;
  for (int32_t k = 2; k >= 0; --k) {
    Int128 part = i128_shift_left(denominator, k);
    if (!i128_less(rest, part)) {
      rest = i128_sub(rest, part);
      quotient |= 1ul << k;
    }
  }
  for (int32_t k = 0; k < 30; ++k) {
    rest = i128_shift_left(rest, 1);
    quotient <<= 1;
    if (!i128_less(rest, denominator)) {
      rest = i128_sub(rest, denominator);
      quotient |= 1ul;
    }
  }
  return quotient;
}
#endif
