// One invocation: a voxel's list (CHUNKS 0), sorted whole if it has at most kSortChunk entries; or (CHUNKS 1) an entry,
// which sorts the chunk of kSortChunk entries of a longer list that it begins, if it begins one.
// Writes the length of the longest list (CHUNKS 0).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(constant_id = 0) const uint32_t CHUNKS = 0u;

layout(scalar, set = 0, binding = 0) readonly buffer ListBegin { uint32_t list_begin[]; };
layout(scalar, set = 0, binding = 1) buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 2) buffer Longest { uint32_t longest; };
layout(push_constant, scalar) uniform Push { uint32_t count, voxels; };

#define LIST_BEGIN list_begin
#include "shaders/lib/list_of_entry.glsl"

void main() {
  uint32_t item = item_index();
  if (item >= count) return;
  uint32_t begin, end;
  if (CHUNKS == 0u) {
    begin = list_begin[item];
    end = list_begin[item + 1u];
    atomicMax(longest, end - begin);
    if (end - begin > kSortChunk) return;
  } else {
    uint32_t voxel = list_of_entry(item, voxels);
    uint32_t start = list_begin[voxel];
    end = list_begin[voxel + 1u];
    if (end - start <= kSortChunk || (item - start) % kSortChunk != 0u) return;
    begin = item;
    end = min(end, begin + kSortChunk);
  }
  for (uint32_t i = begin + 1u; i < end; ++i) {
    uint32_t id = list_triangles[i], j = i;
    for (; j > begin && list_triangles[j - 1u] > id; --j) list_triangles[j] = list_triangles[j - 1u];
    list_triangles[j] = id;
  }
}
