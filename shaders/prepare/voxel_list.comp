// One invocation: an item (triangle, brick). Finds the brick's voxels that, closed and grown, touch the
// triangle. emit 0: marks them as boundary and writes their number to counts. emit 1: reads counts, now
// prefix sums, writes pairs (triangle, compact index of the voxel) and counts the triangles of each voxel.
// Before emit 1: first[] of every brick.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer ItemTriangle { uint32_t item_triangle[]; };
layout(scalar, set = 0, binding = 3) readonly buffer ItemCell { uint32_t item_cell[]; };
layout(scalar, set = 0, binding = 4) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 5) buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 6) buffer Counts { uint32_t counts[]; };
layout(scalar, set = 0, binding = 7) writeonly buffer PairTriangle { uint32_t pair_triangle[]; };
layout(scalar, set = 0, binding = 8) writeonly buffer PairVoxel { uint32_t pair_voxel[]; };
layout(scalar, set = 0, binding = 9) buffer ListCount { uint32_t list_count[]; };
layout(push_constant, scalar) uniform Push { VoxelPush push; };

void main() {
  uint32_t item = item_index();
  if (item >= push.count) return;
  uint32_t t = item_triangle[item], brick = item_cell[item], slot = brick_slot[brick];
  uvec3 corner = triangles[t];
  ivec3 a = vertices[corner.x], b = vertices[corner.y], c = vertices[corner.z];
  ivec3 base = cell_of_number(brick, push.bricks) * 8;
  ivec3 first = max(first_cell(min(a, min(b, c)), push.origin, push.size, push.growth), base) - base;
  ivec3 last =
      min(last_cell(max(a, max(b, c)), push.origin, push.size, push.growth, push.bricks * 8), base + 7) -
      base;
  ivec3 corner_of_brick = push.origin + base * push.size;
  i64vec3 n = raw_normal(a, b, c);
  uint32_t at = push.emit != 0u ? push.out_base + counts[item] : 0u;
  uint32_t found = 0u;
  ivec3 voxel = first;
  while (all(lessThanEqual(voxel, last))) {   // one loop: see triangle_expand
    ivec3 lo = corner_of_brick + voxel * push.size;
    if (triangle_touches_box(a, b, c, n, lo - push.growth, lo + push.size + push.growth)) {
      uint32_t bit = uint32_t(voxel.x | voxel.y << 3 | voxel.z << 6);
      uint32_t word = bit >> 5, mask = 1u << (bit & 31u);
      if (push.emit == 0u) {
        atomicOr(bricks[slot].boundary[word], mask);
      } else {
        uint32_t index =
            bricks[slot].first[word] + uint32_t(bitCount(bricks[slot].boundary[word] & (mask - 1u)));
        pair_triangle[at + found] = t;
        pair_voxel[at + found] = index;
        atomicAdd(list_count[index], 1u);
      }
      ++found;
    }
    voxel = next_cell(voxel, first, last);
  }
  if (push.emit == 0u) counts[item] = found;
}
