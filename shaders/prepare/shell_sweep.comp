// One invocation: a row of voxels along `axis`. Goes through its mixed bricks from where walks end, and knows
// at each boundary voxel what a walk from its middle on says: what it crosses, and 1 more where it ends in
// V_int. shells[] keeps the least, of those that end near if there are any.
// Before: row_link from the same end; classes; what half voxels are crossed by.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(constant_id = 0) const bool UP = true;     // walks go that way along the axis
layout(constant_id = 1) const bool LAST = true;   // no sweep follows

layout(scalar, set = 0, binding = 0) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Halves { int32_t halves[]; };
layout(scalar, set = 0, binding = 4) readonly buffer RowHead { uint32_t row_head[]; };
layout(scalar, set = 0, binding = 5) readonly buffer RowLink { uint32_t row_link[]; };
layout(scalar, set = 0, binding = 6) buffer Shells { int32_t shells[]; };
layout(push_constant, scalar) uniform Push { GridPush push; };

const uint32_t kNearWalk = 8u;   // voxels (docs/EXACTNESS.md section 4)
// Added to what a walk says that ends further away: more than any says, so that what is near comes first. No
// line is crossed by 2^29 triangles.
const int32_t kFar = 1 << 30;

void put(uint32_t voxel, int32_t said, bool near) {
  const int32_t least = min(shells[voxel], near ? said : said + kFar);
  shells[voxel] = LAST && least >= kFar / 2 ? least - kFar : least;
}

void main() {
  const uint32_t row = item_index();
  if (row >= push.count) return;
  const uint32_t axis = push.axis, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  const uint32_t rows_u = uint32_t(push.bricks[u]) * 8u, iu = row % rows_u, iv = row / rows_u;
  ivec3 brick = ivec3(0);
  brick[u] = int32_t(iu >> 3);
  brick[v] = int32_t(iv >> 3);
  const uint32_t row_bit = (iu & 7u) << (u * 3u) | (iv & 7u) << (v * 3u);
  const int32_t back = UP ? -1 : 1;   // a step against the walks
  int32_t said = 0, after = UP ? push.bricks[axis] : -1;   // place of the mixed brick left last
  uint32_t length = 0u;                                    // of the walks from the last voxel, voxels
  for (uint32_t slot = row_head[(iu >> 3) + (rows_u >> 3) * (iv >> 3)]; slot != kNoVoxel;
       slot = row_link[slot]) {
    const int32_t at = cell_of_number(mixed_brick[slot], push.bricks)[axis];
    if (after + back != at) {   // a uniform brick ends the walks
      brick[axis] = at - back;
      said = brick_slot[cell_number(brick, push.bricks)] == kBrickInternal ? 1 : 0;
      length = 0u;
    }
    after = at;
    for (uint32_t i = 0u; i < 8u; ++i) {
      const uint32_t bit = row_bit | (UP ? 7u - i : i) << (axis * 3u), mask = 1u << (bit & 31u),
                     word = bricks[slot].boundary[bit >> 5];
      if ((word & mask) == 0u) {
        said = (bricks[slot].internal_[bit >> 5] & mask) != 0u ? 1 : 0;
        length = 0u;
        continue;
      }
      const uint32_t voxel = bricks[slot].first[bit >> 5] + uint32_t(bitCount(word & (mask - 1u)));
      const int32_t low = halves[2u * voxel], high = halves[2u * voxel + 1u];
      put(voxel, said + (UP ? high : -low), ++length <= kNearWalk);
      said += UP ? low + high : -low - high;
    }
  }
}
