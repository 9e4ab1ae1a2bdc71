// One invocation: a chunk of kScanChunk numbers. Reads values, writes the chunk's sum to sums.
// Exclusive prefix sums, first step. Sums stay at 2^32 − 1 once there: the host refuses such a total.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/scan.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer Values { uint32_t values[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer Sums { uint32_t sums[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t first = item_index() * kScanChunk;
  if (first >= count) return;
  uint32_t end = min(first + kScanChunk, count), sum = 0u;
  for (uint32_t i = first; i < end; ++i) sum = add_saturated(sum, values[i]);
  sums[item_index()] = sum;
}
