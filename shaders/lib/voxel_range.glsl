// Which cells of a regular grid a closed box touches; cells are closed too, so a face between two touches
// both.
#ifndef PALPATE_VOXEL_RANGE_GLSL
#define PALPATE_VOXEL_RANGE_GLSL

int32_t first_touched(int32_t low, int32_t origin, int32_t side) { return floor_div(low - origin - 1, side); }
int32_t last_touched(int32_t high, int32_t origin, int32_t side) { return floor_div(high - origin, side); }

ivec3 first_touched(ivec3 low, ivec3 origin, int32_t side) {
  return ivec3(first_touched(low.x, origin.x, side), first_touched(low.y, origin.y, side),
               first_touched(low.z, origin.z, side));
}
ivec3 last_touched(ivec3 high, ivec3 origin, int32_t side) {
  return ivec3(last_touched(high.x, origin.x, side), last_touched(high.y, origin.y, side),
               last_touched(high.z, origin.z, side));
}

// floor(d / side) for cells 0 … n − 1 with n ≤ 2^15; −1 for what is below, n for what is beyond. A float
// quotient is less than one off on any device: the division's 2.5 ULP and two roundings are under 2^-21 of at
// most 2^15. An integer division costs llvmpipe a loop over its lanes.
ivec3 cell_along(ivec3 d, int32_t side, ivec3 n) {
  const ivec3 inside = clamp(d, ivec3(-1), n * side);
  const ivec3 q = ivec3(floor(vec3(inside) * (1.0 / float(side))));
  const ivec3 rest = inside - q * side;
  return q + ivec3(greaterThanEqual(rest, ivec3(side))) - ivec3(lessThan(rest, ivec3(0)));
}
ivec3 cell_along(ivec3 d, int32_t side, int32_t n) { return cell_along(d, side, ivec3(n)); }

// Coordinates of a brick from its linear number.
ivec3 brick_at(uint32_t number, ivec3 bricks) {
  const uint32_t x = uint32_t(bricks.x), y = uint32_t(bricks.y);
  return ivec3(number % x, number / x % y, number / (x * y));
}

// Coordinates of a voxel inside its brick from its bit.
ivec3 voxel_at(uint32_t bit) { return ivec3(bit & 7u, bit >> 3 & 7u, bit >> 6); }
#endif
