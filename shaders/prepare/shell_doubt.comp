// One invocation: a boundary voxel of a body that is not closed. Asks its 26 neighbours in how many shells
// they see its middle, along the axes from middle to middle, and keeps which say less of it than itself, and
// of which it says less: bit x + 3 y + 9 z of 27, 13 its own.
// Before: shell_sweep along all axes; what half voxels are crossed by along each. Writes behind all shells.
// Counts the voxels whose middle is in one, and those that see a neighbour otherwise than it does itself, or
// are seen so.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 3) readonly buffer BoundaryPlace { uint32_t boundary_place[]; };
layout(scalar, set = 0, binding = 4) readonly buffer HalvesX { int32_t halves_x[]; };
layout(scalar, set = 0, binding = 5) readonly buffer HalvesY { int32_t halves_y[]; };
layout(scalar, set = 0, binding = 6) readonly buffer HalvesZ { int32_t halves_z[]; };
layout(scalar, set = 0, binding = 7) buffer Shells { int32_t shells[]; };
layout(scalar, set = 0, binding = 8) buffer Counts { uint32_t in_a_shell, in_doubt; };
layout(push_constant, scalar) uniform Push { GridPush push; };

const uint32_t kOwn = 13u;
uint32_t boundary_of[27];   // by place, as the bits
int32_t shells_of[27];

void look(uint32_t place, ivec3 voxel) {
  boundary_of[place] = kNoVoxel;
  shells_of[place] = 0;
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, 8 * push.bricks))) return;
  const uint32_t slot = brick_slot[cell_number(voxel >> 3, push.bricks)];
  if (slot >= kBrickInternal) {
    shells_of[place] = slot == kBrickInternal ? 1 : 0;
    return;
  }
  const uint32_t bit = uint32_t(voxel.x & 7) | uint32_t(voxel.y & 7) << 3 | uint32_t(voxel.z & 7) << 6,
                 mask = 1u << (bit & 31u), word = bricks[slot].boundary[bit >> 5];
  if ((word & mask) == 0u) {
    shells_of[place] = (bricks[slot].internal_[bit >> 5] & mask) != 0u ? 1 : 0;
    return;
  }
  boundary_of[place] = bricks[slot].first[bit >> 5] + uint32_t(bitCount(word & (mask - 1u)));
  shells_of[place] = shells[boundary_of[place]];
}

// Up the axis, in the half of a voxel before its middle (0) or beyond (1).
int32_t half_of(uint32_t place, uint32_t axis, uint32_t beyond) {
  const uint32_t boundary = boundary_of[place];
  if (boundary == kNoVoxel) return 0;
  const uint32_t at = 2u * boundary + beyond;
  return axis == 0u ? halves_x[at] : axis == 1u ? halves_y[at] : halves_z[at];
}

void main() {
  const uint32_t voxel = item_index();
  if (voxel >= push.count) return;
  if (shells[voxel] > 0) atomicAdd(in_a_shell, 1u);
  const uint32_t place = boundary_place[voxel];
  const ivec3 home = cell_of_number(mixed_brick[place >> 9], push.bricks) * 8 +
                     ivec3(int32_t(place & 7u), int32_t(place >> 3 & 7u), int32_t(place >> 6 & 7u));
  for (uint32_t i = 0u; i < 27u; ++i) look(i, home + ivec3(i % 3u, i / 3u % 3u, i / 9u) - 1);
  uint32_t less = 0u, more = 0u;
  for (uint32_t i = 0u; i < 27u; ++i) {
    // The way goes from the one that is first in the grid.
    const bool from_own = i >= kOwn;
    const uint32_t end = from_own ? i : kOwn;
    uint32_t at = from_own ? kOwn : i, stride = 1u;
    int32_t crossed = 0;
    for (uint32_t axis = 0u; axis < 3u; ++axis) {
      const uint32_t from = at / stride % 3u, to = end / stride % 3u;
      if (from != to) {
        const uint32_t next = at + (to - from) * stride;   // modulo 2^32
        crossed += to > from ? half_of(at, axis, 1u) + half_of(next, axis, 0u)
                             : -half_of(at, axis, 0u) - half_of(next, axis, 1u);
        at = next;
      }
      stride *= 3u;
    }
    const int32_t seen = from_own ? shells_of[i] + crossed - shells_of[kOwn]
                                  : shells_of[i] - (shells_of[kOwn] + crossed);
    less |= uint32_t(seen < 0) << i;
    more |= uint32_t(seen > 0) << i;
  }
  if ((less | more) != 0u) atomicAdd(in_doubt, 1u);
  shells[push.count + 2u * voxel] = int32_t(less);
  shells[push.count + 2u * voxel + 1u] = int32_t(more);
}
