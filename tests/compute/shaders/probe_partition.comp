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
uint32_t probed_slots(uint32_t brick) { return PALPATE_PROBE_SLOT(brick); }
uint32_t probed_bricks(uint32_t word) {
  const uint32_t slot = word / kBrickWords, w = word % 16u;
  return word % kBrickWords < kBrickInternalWord ? PALPATE_PROBE_BOUNDARY(slot, w)
         : word % kBrickWords < kBrickFirstWord  ? PALPATE_PROBE_INTERNAL(slot, w)
                                                 : PALPATE_PROBE_FIRST(slot, w);
}
#define PARTITION_GRID cases[probed].grid
#define PARTITION_SLOTS probed_slots
#define PARTITION_BRICKS probed_bricks
#define PARTITION(name) probed_##name
#include "shaders/lib/partition.glsl"

void main() {
  probed = item_index();
  if (probed >= count) return;
  const ivec3 voxel = cases[probed].voxel;
  answers[probed] = PartitionAnswer(probed_voxel_of(cases[probed].point), probed_class_of(voxel), probed_boundary_index(voxel));
}
