// One invocation: an entry of a voxel's list. Its place among the kRankSpan entries of its chunk of the list
// is the number of smaller ones. Reads lists, writes sorted; lists longer than a chunk raise `longest` and
// are left to list_merge.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(scalar, set = 0, binding = 0) readonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(scalar, set = 0, binding = 1) readonly buffer ListBegin { uint32_t list_begin[]; };
layout(scalar, set = 0, binding = 2) readonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer Sorted { uint32_t sorted[]; };
layout(scalar, set = 0, binding = 4) buffer Longest { uint32_t longest; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t entry = item_index();
  if (entry >= count) return;
  uint32_t voxel = entry_voxel[entry];
  uint32_t begin = list_begin[voxel], end = list_begin[voxel + 1u];
  if (end - begin > kRankSpan) {
    if (entry == begin) atomicMax(longest, end - begin);
    begin += (entry - begin) / kRankSpan * kRankSpan;
    end = min(end, begin + kRankSpan);
  }
  uint32_t id = list_triangles[entry], rank = 0u;
  // Ids in a list are distinct.
  for (uint32_t i = begin; i < end; ++i) rank += list_triangles[i] < id ? 1u : 0u;
  sorted[begin + rank] = id;
}
