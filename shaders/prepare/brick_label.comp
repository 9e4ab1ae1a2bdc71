// One invocation: a mixed brick. Finds the components of its voxels that are not boundary, connected through
// faces inside the brick, by flooding eight slices of 64 bits. Writes their number, and each voxel's
// component in bit planes: bit k of the component of voxel `bit` is bit of labels[slot · 128 + k · 16 …].
// Before: labels are 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Bricks { Brick bricks[]; };
layout(scalar, set = 0, binding = 1) buffer Labels { uint32_t labels[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer Counts { uint32_t counts[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

// Loops stay loops: unrolled, the driver takes a second to compile this.
const uint64_t kColumn0 = 0x0101010101010101ul;   // voxels with x = 0
const uint64_t kColumn7 = 0x8080808080808080ul;

// Cells of `open` that a straight walk from r reaches through `open`, along +x, −x, +y and −y one after the
// other. Each walk doubles its stride: 1, 2 and 4 cells cover a slice.
uint64_t flood_slice(uint64_t r, uint64_t open) {
  uint64_t pass = open & ~kColumn0;
  r |= pass & r << 1;
  pass &= pass << 1;
  r |= pass & r << 2;
  pass &= pass << 2;
  r |= pass & r << 4;
  pass = open & ~kColumn7;
  r |= pass & r >> 1;
  pass &= pass >> 1;
  r |= pass & r >> 2;
  pass &= pass >> 2;
  r |= pass & r >> 4;
  pass = open;
  r |= pass & r << 8;
  pass &= pass << 8;
  r |= pass & r << 16;
  pass &= pass << 16;
  r |= pass & r << 32;
  pass = open;
  r |= pass & r >> 8;
  pass &= pass >> 8;
  r |= pass & r >> 16;
  pass &= pass >> 16;
  r |= pass & r >> 32;
  return r;
}

void main() {
  uint32_t slot = item_index();
  if (slot >= count) return;
  uint64_t open[8];   // voxels without a component yet
  uint64_t left = 0ul;
  [[dont_unroll]] for (int32_t z = 0; z < 8; ++z) {
    open[z] = ~(uint64_t(bricks[slot].boundary[2 * z]) | uint64_t(bricks[slot].boundary[2 * z + 1]) << 32);
    left |= open[z];
  }
  uint32_t components = 0u;
  while (left != 0ul) {   // at most 256 times (a chequered brick)
    uint64_t region[8];
    bool seeded = false;
    [[dont_unroll]] for (int32_t z = 0; z < 8; ++z) {
      region[z] = seeded ? 0ul : open[z] & (~open[z] + 1ul);
      seeded = seeded || open[z] != 0ul;
    }
    // Sweeps upwards and downwards in turn; inside a slice the flood runs on to the next obstacle at once.
    bool grown = true;
    for (int32_t sweep = 0; grown; ++sweep) {
      grown = false;
      [[dont_unroll]] for (int32_t i = 0; i < 8; ++i) {
        int32_t z = (sweep & 1) == 0 ? i : 7 - i;
        uint64_t r = region[z];
        if (z > 0) r |= region[z - 1];
        if (z < 7) r |= region[z + 1];
        r = flood_slice(r & open[z], open[z]);
        grown = grown || r != region[z];
        region[z] = r;
      }
    }
    left = 0ul;
    [[dont_unroll]] for (int32_t z = 0; z < 8; ++z) {
      open[z] &= ~region[z];
      left |= open[z];
    }
    [[dont_unroll]] for (uint32_t plane = 0u; plane < 8u; ++plane) {
      if ((components >> plane & 1u) == 0u) continue;
      [[dont_unroll]] for (int32_t z = 0; z < 8; ++z) {
        uint32_t word = slot * 128u + plane * 16u + 2u * uint32_t(z);
        labels[word] |= uint32_t(region[z]);
        labels[word + 1u] |= uint32_t(region[z] >> 32);
      }
    }
    ++components;
  }
  counts[slot] = components;
}
