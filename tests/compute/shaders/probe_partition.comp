// One invocation: one point and one voxel of one made-up partition. Reads cases, writes the point's voxel, and what the other voxel is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "tests/compute/shaders/probe_frame.h"

layout(scalar, set = 0, binding = 0) readonly buffer Cases { PartitionCase cases[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Answers { PartitionAnswer answers[]; };
layout(push_constant) uniform Push { uint32_t count; };

uint32_t probed;
uint32_t probed_slots[64];   // beyond 27 bricks, too
Brick probed_bricks[2];
#define PARTITION_GRID cases[probed].grid
#define PARTITION_SLOTS probed_slots
#define PARTITION_BRICKS probed_bricks
#define PARTITION(name) probed_##name
#include "shaders/lib/partition.glsl"

void main() {
  probed = item_index();
  if (probed >= count) return;
  for (uint32_t b = 0u; b < 64u; ++b) probed_slots[b] = PALPATE_PROBE_SLOT(b);
  for (uint32_t slot = 0u; slot < 2u; ++slot)
    for (uint32_t w = 0u; w < 16u; ++w) {
      probed_bricks[slot].boundary[w] = PALPATE_PROBE_BOUNDARY(slot, w);
      probed_bricks[slot].internal_[w] = PALPATE_PROBE_INTERNAL(slot, w);
      probed_bricks[slot].first[w] = PALPATE_PROBE_FIRST(slot, w);
    }
  const ivec3 voxel = cases[probed].voxel;
  answers[probed] = PartitionAnswer(probed_voxel_of(cases[probed].point), probed_class_of(voxel), probed_boundary_index(voxel));
}
