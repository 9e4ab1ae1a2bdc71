// One invocation: a chunk of kScanChunk numbers. Reads values and, in bases, the sum of all chunks before
// each; replaces every value by the sum of all values before it. Second step; `has_bases` is 0 for a lone
// chunk.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/scan.glsl"

layout(scalar, set = 0, binding = 0) buffer Values { uint32_t values[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Bases { uint32_t bases[]; };
layout(push_constant, scalar) uniform Push { uint32_t count, has_bases; };

void main() {
  uint32_t first = item_index() * kScanChunk;
  if (first >= count) return;
  uint32_t end = min(first + kScanChunk, count);
  uint32_t sum = has_bases != 0u ? bases[item_index()] : 0u;
  for (uint32_t i = first; i < end; ++i) {
    uint32_t value = values[i];
    values[i] = sum;
    sum = add_saturated(sum, value);
  }
}
