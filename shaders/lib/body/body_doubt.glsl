// How far the voxels of a body that is not closed agree which points lie inside it (docs/EXACTNESS.md section
// 4, "Doubt"). The including shader has what lib/body/body.glsl asks for, and WORDS body_shells.
#ifndef PALPATE_LIB_BODY_DOUBT
#define PALPATE_LIB_BODY_DOUBT
#include "shaders/lib/body/body.glsl"

// Of a V_bnd voxel's neighbours, those that say less of it than itself, and of which it says less.
uint32_t body_less(uint32_t boundary) {
  return uint32_t(body_shells(BODY_GRID.boundary_voxels + 2u * boundary));
}
uint32_t body_more(uint32_t boundary) {
  return uint32_t(body_shells(BODY_GRID.boundary_voxels + 2u * boundary + 1u));
}

// Whether it matters in how many shells a point of the voxel is that lies inside.
bool body_doubted(ivec3 voxel) {
  const uint32_t boundary = body_boundary_index(voxel);
  return boundary != kNoVoxel && body_less(boundary) != 0u;
}

// What is left of the weight of a sample at a point inside, in so many shells.
uint32_t body_sure(uint32_t weight, ivec3 point, int32_t shells) {
  const ivec3 voxel = body_voxel_of(point);
  const uint32_t boundary = body_boundary_index(voxel);
  const uint32_t less = boundary == kNoVoxel ? 0u : body_less(boundary);
  if (shells != 1 || (boundary != kNoVoxel && less == 0u)) return weight;
  // Within half a voxel are only neighbours on the near side of the middle, along each axis.
  const int32_t size = BODY_GRID.size;
  const ivec3 within = point - (BODY_GRID.origin + size * voxel);
  const bvec3 down = lessThan(2 * within, ivec3(size));
  const ivec3 side = mix(ivec3(1), ivec3(-1), down), way = mix(size - within, within, down);
  int32_t nearest = size;   // twice the way to the nearest that says less
  for (int32_t axes = 1; axes < 8; ++axes) {
    const ivec3 along = ivec3(axes & 1, axes >> 1 & 1, axes >> 2), to = along * side, ways = along * way;
    const int32_t twice = 2 * max(max(ways.x, ways.y), ways.z);
    if (twice >= nearest) continue;
    const uint32_t number = uint32_t(13 + to.x + 3 * to.y + 9 * to.z);
    bool says_less = (less >> number & 1u) != 0u;
    if (boundary == kNoVoxel) {
      const uint32_t there = body_boundary_index(voxel + to);
      says_less = there != kNoVoxel && (body_more(there) >> (26u - number) & 1u) != 0u;
    }
    if (says_less) nearest = twice;
  }
  if (nearest == size) return weight;
  return uint32_t((uint64_t(weight) * uint64_t(uint32_t(nearest) * (0x80000000u / uint32_t(size)))) >> 31);
}
#endif
