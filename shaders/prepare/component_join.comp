// One invocation: a brick and an axis (item = brick · 3 + axis). Joins the nodes that meet at the brick's
// upper face, and with node 0 those that lie at the grid's border. The smallest node of a tree is its root. A
// union that loses too many races or walks too far raises `again`: the host runs all once more, which does no
// harm.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 2) readonly buffer ComponentFirst { uint32_t component_first[]; };
layout(scalar, set = 0, binding = 3) readonly buffer Labels { uint32_t labels[]; };
layout(scalar, set = 0, binding = 4) coherent buffer Parent { uint32_t parent[]; };
layout(scalar, set = 0, binding = 5) buffer Again { uint32_t again; };
layout(push_constant, scalar) uniform Push { GridPush push; };

#define NODE_BRICKS uint32_t(push.bricks.x * push.bricks.y * push.bricks.z)
#include "shaders/lib/components.glsl"

// Root of a node, halving the path. Every parent is smaller than its child, so this ends.
uint32_t root_of(uint32_t node) {
  for (uint32_t k = 0u; k < kFindSteps; ++k) {
    uint32_t up = parent[node];
    if (up == node) return node;
    uint32_t over = parent[up];
    if (over != up) atomicMin(parent[node], over);
    node = over;
  }
  atomicMax(again, 1u);
  return node;
}

void join(uint32_t a, uint32_t b) {
  for (uint32_t k = 0u; k < kUnionTries; ++k) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return;
    uint32_t low = min(a, b), high = max(a, b);
    // Only a root is hung, and only while it still is one.
    if (atomicCompSwap(parent[high], high, low) == high) return;
  }
  atomicMax(again, 1u);
}

// Bit of voxel (i, j) of a face at `depth` along the axis.
uint32_t face_bit(uint32_t axis, uint32_t depth, uint32_t i, uint32_t j) {
  return axis == 0u ? depth | i << 3 | j << 6
                    : (axis == 1u ? i | depth << 3 | j << 6 : i | j << 3 | depth << 6);
}

// Nodes of one side of a face.
struct Side {
  bool mixed;
  uint32_t node;      // of a uniform brick, or 0 beyond the border
  BrickNodes nodes;   // of a mixed one
};

Side side_of(uint32_t slot, uint32_t brick) {
  bool mixed = slot < kBrickInternal;
  return Side(mixed, uniform_node(brick), brick_nodes(mixed ? slot : 0u));
}

// Node of a face's voxel; kNoVoxel for a boundary voxel.
uint32_t node_at(Side side, uint32_t bit) {
  if (!side.mixed) return side.node;
  bool boundary = (bricks[side.nodes.slot].boundary[bit >> 5] >> (bit & 31u) & 1u) != 0u;
  return boundary ? kNoVoxel : voxel_node(side.nodes, bit);
}

void main() {
  uint32_t item = item_index();
  if (item >= push.count) return;
  uint32_t brick = item / 3u, axis = item - brick * 3u;
  ivec3 cell = cell_of_number(brick, push.bricks);
  uint32_t slot = brick_slot[brick];
  Side here = side_of(slot, brick);

  // Sides: 0 the lower border, if this is it; 1 the upper face, towards the next brick or beyond the border.
  for (uint32_t side = cell[axis] == 0 ? 0u : 1u; side < 2u; ++side) {
    bool border = side == 0u || cell[axis] == push.bricks[axis] - 1;
    uint32_t next = brick, next_slot = slot;
    if (!border) {
      ivec3 other = cell;
      other[axis] += 1;
      next = cell_number(other, push.bricks);
      next_slot = brick_slot[next];
    }
    uint32_t last_a = kNoVoxel, last_b = kNoVoxel;
    bool plain = slot >= kBrickInternal && (border || next_slot >= kBrickInternal);
    if (plain && axis == 0u) continue;   // row_init joined them
    Side there = side_of(next_slot, next);
    if (border) there = Side(false, 0u, here.nodes);
    uint32_t voxels = plain ? 1u : 64u;
    for (uint32_t v = 0u; v < voxels; ++v) {
      uint32_t a = node_at(here, face_bit(axis, side == 0u ? 0u : 7u, v & 7u, v >> 3));
      if (a == kNoVoxel) continue;
      uint32_t b = node_at(there, face_bit(axis, 0u, v & 7u, v >> 3));
      if (b == kNoVoxel || (a == last_a && b == last_b)) continue;
      join(a, b);
      last_a = a;
      last_b = b;
    }
  }
}
