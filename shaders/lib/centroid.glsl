// floor((a + b + c) / 3), component by component; coordinates within 2^28, so that the sum fits 32 bits.
#ifndef PALPATE_LIB_CENTROID
#define PALPATE_LIB_CENTROID
ivec3 rounded_centroid(ivec3 a, ivec3 b, ivec3 c) {
  const ivec3 sum = a + b + c;
  return ivec3(floor_div(sum.x, 3), floor_div(sum.y, 3), floor_div(sum.z, 3));
}
#endif
