// Sorts the voxels' lists by rank: an entry's place is the number of smaller ones. CHUNKS 0: one invocation is a pair
// (triangle, voxel), for lists of at most kRankSpan entries; longer ones raise `longest`. CHUNKS 1: one invocation is an
// entry, for the longer lists, and ranks in its chunk of kRankSpan entries. Reads lists, writes sorted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(constant_id = 0) const uint32_t CHUNKS = 0u;

layout(scalar, set = 0, binding = 0) readonly buffer PairTriangle { uint32_t pair_triangle[]; };
layout(scalar, set = 0, binding = 1) readonly buffer PairVoxel { uint32_t pair_voxel[]; };
layout(scalar, set = 0, binding = 2) readonly buffer ListBegin { uint32_t list_begin[]; };
layout(scalar, set = 0, binding = 3) readonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 4) writeonly buffer Sorted { uint32_t sorted[]; };
layout(scalar, set = 0, binding = 5) buffer Longest { uint32_t longest; };
layout(push_constant, scalar) uniform Push { uint32_t count, voxels; };

#define LIST_BEGIN list_begin
#include "shaders/lib/list_of_entry.glsl"

void main() {
  uint32_t item = item_index();
  if (item >= count) return;
  uint32_t voxel = CHUNKS == 0u ? pair_voxel[item] : list_of_entry(item, voxels);
  uint32_t begin = list_begin[voxel], end = list_begin[voxel + 1u];
  bool is_long = end - begin > kRankSpan;
  uint32_t id;
  if (CHUNKS == 0u) {
    if (is_long) {
      atomicMax(longest, end - begin);
      return;
    }
    id = pair_triangle[item];
  } else {
    if (!is_long) return;
    id = list_triangles[item];
    begin += (item - begin) / kRankSpan * kRankSpan;
    end = min(end, begin + kRankSpan);
  }
  uint32_t rank = 0u;
  for (uint32_t i = begin; i < end; ++i) rank += list_triangles[i] < id ? 1u : 0u;   // ids in a list are distinct
  sorted[begin + rank] = id;
}
