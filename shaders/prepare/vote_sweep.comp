// One invocation: a row of voxels along `axis`. Walks its mixed bricks from the far end and keeps the
// winding, the sum of the crossings passed; every voxel that is not boundary gives its component's root a
// vote: +1 where the winding is not 0, else −1. Components that reach the border get none. Before: parents
// are roots; row_link along this axis.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 2) readonly buffer ComponentFirst { uint32_t component_first[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Labels { uint32_t labels[]; };
layout(scalar, set = 0, binding = 4) readonly buffer Parent { uint32_t parent[]; };
layout(scalar, set = 0, binding = 5) readonly buffer Crossings { int32_t crossings[]; };
layout(scalar, set = 0, binding = 6) buffer Votes { int64_t votes[]; };
layout(scalar, set = 0, binding = 7) readonly buffer RowHead { uint32_t row_head[]; };
layout(scalar, set = 0, binding = 8) readonly buffer RowLink { uint32_t row_link[]; };
layout(scalar, set = 0, binding = 9) readonly buffer Enclosed { uint32_t enclosed[]; };
layout(push_constant, scalar) uniform Push { GridPush push; uint32_t first_crossing; };

#define NODE_BRICKS uint32_t(push.bricks.x * push.bricks.y * push.bricks.z)
#include "shaders/lib/components.glsl"

uint32_t vote_root = 0u;   // the root that `vote_sum` is for; 0: none
int64_t vote_sum = 0l;

void flush() {
  if (vote_root != 0u && vote_sum != 0l) atomicAdd(votes[vote_root], vote_sum);
  vote_sum = 0l;
}

void vote(uint32_t root, int32_t winding, int64_t ballots) {
  if (root != vote_root) {
    flush();
    vote_root = root;
  }
  vote_sum += winding != 0 ? ballots : -ballots;
}

void main() {
  uint32_t row = item_index();
  if (row >= push.count) return;
  uint32_t axis = push.axis, u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  uint32_t rows_u = uint32_t(push.bricks[u]) * 8u;
  uint32_t iu = row % rows_u, iv = row / rows_u;
  ivec3 brick = ivec3(0);
  brick[u] = int32_t(iu >> 3);
  brick[v] = int32_t(iv >> 3);
  uint32_t row_bit = (iu & 7u) << (u * 3u) | (iv & 7u) << (v * 3u);
  int32_t winding = 0, after = push.bricks[axis];   // place of the mixed brick walked last
  for (uint32_t slot = row_head[(iu >> 3) + (rows_u >> 3) * (iv >> 3)];; slot = row_link[slot]) {
    int32_t at = slot == kNoVoxel ? -1 : cell_of_number(mixed_brick[slot], push.bricks)[axis];
    // The uniform bricks between two mixed ones touch each other: one component.
    if (after - at > 1) {
      brick[axis] = at + 1;
      vote(parent[uniform_node(cell_number(brick, push.bricks))], winding, 8l * int64_t(after - at - 1));
    }
    if (slot == kNoVoxel) break;
    after = at;
    bool votes_here = enclosed[slot] != 0u;
    BrickNodes nodes = brick_nodes(slot);
    for (int32_t i = 7; i >= 0; --i) {
      uint32_t bit = row_bit | uint32_t(i) << (axis * 3u);
      uint32_t word = bricks[slot].boundary[bit >> 5], mask = 1u << (bit & 31u);
      if ((word & mask) != 0u) {
        uint32_t voxel = bricks[slot].first[bit >> 5] + uint32_t(bitCount(word & (mask - 1u)));
        winding += crossings[first_crossing + voxel];
      } else if (votes_here) {
        vote(parent[voxel_node(nodes, bit)], winding, 1l);
      }
    }
  }
  flush();
}
