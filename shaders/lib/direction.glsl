// Directions from sums of normals, docs/EXACTNESS.md section 6.
#ifndef PALPATE_LIB_DIRECTION
#define PALPATE_LIB_DIRECTION

int64_t largest_component(i64vec3 s) { return max(max(abs(s.x), abs(s.y)), abs(s.z)); }

i64vec3 vector_of(int64_t s[3]) { return i64vec3(s[0], s[1], s[2]); }

// Highest set bit of v > 0.
int32_t highest_bit(int64_t v) {
  const uint32_t high = uint32_t(uint64_t(v) >> 32);
  return high != 0u ? 32 + findMSB(high) : findMSB(uint32_t(v));
}

// S ≠ 0 shifted until its largest |component| is in [2^28, 2^29); right shifts round towards 0.
ivec3 normalise(i64vec3 s) {
  const int32_t k = 28 - highest_bit(largest_component(s));
  if (k >= 0) return ivec3(s << k);
  return ivec3(sign(s) * (abs(s) >> -k));
}
#endif
