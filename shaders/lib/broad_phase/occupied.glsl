// A look at a range of voxels of the mock-up's grid: cubes of 1, 2, 4 and 8 voxels, and of as many bricks,
// bricks of bricks and so on, say by one bit, from each on, whether one of theirs is not V_ext. The including
// shader declares uint32_t occupied[]: the number of levels; for each level its size in bricks (x, y, z) and
// the words at which the bricks' places and their cubes begin; places; cubes, kCubeWords a place
// (compute/gpu/prepare/occupied.h).
#ifndef PALPATE_LIB_OCCUPIED
#define PALPATE_LIB_OCCUPIED

const uint32_t kLevelWords = 5u, kCubeWords = 64u;

// Errs towards true. The range lies in the grid.
bool may_be_occupied(ivec3 first, ivec3 last) {
  uint32_t level = 0u;
  while (any(greaterThan(last - first, ivec3(7)))) {   // at most five times: the last level is one brick
    first >>= 3;
    last >>= 3;
    ++level;
  }
  const ivec3 n = last - first;
  const int32_t beyond = max(max(n.x, n.y), n.z);
  const uint32_t cube = uint32_t(beyond > 0) + uint32_t(beyond > 1) + uint32_t(beyond > 3);
  const uint32_t head = 1u + kLevelWords * level;
  const uvec3 brick = uvec3(first >> 3);
  const uint32_t number = brick.x + occupied[head] * (brick.y + occupied[head + 1u] * brick.z);
  const uint32_t bit = uint32_t(first.x & 7) | uint32_t(first.y & 7) << 3 | uint32_t(first.z & 7) << 6;
  const uint32_t place = occupied[occupied[head + 3u] + number];
  const uint32_t word = occupied[occupied[head + 4u] + kCubeWords * place + 16u * cube + (bit >> 5)];
  return (word >> (bit & 31u) & 1u) != 0u;
}
#endif
