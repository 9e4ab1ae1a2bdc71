// One invocation: a pair (triangle, boundary voxel). Puts the triangle into the voxel's list at the next free
// place; cursors start as the lists' begins. Notes the voxel of every entry. The order inside a list is left
// to list_rank.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"

layout(scalar, set = 0, binding = 0) readonly buffer PairTriangle { uint32_t pair_triangle[]; };
layout(scalar, set = 0, binding = 1) readonly buffer PairVoxel { uint32_t pair_voxel[]; };
layout(scalar, set = 0, binding = 2) buffer Cursors { uint32_t cursors[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 4) writeonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(push_constant, scalar) uniform Push { uint32_t count; };

void main() {
  uint32_t pair = item_index();
  if (pair >= count) return;
  uint32_t voxel = pair_voxel[pair];
  uint32_t entry = atomicAdd(cursors[voxel], 1u);
  list_triangles[entry] = pair_triangle[pair];
  entry_voxel[entry] = voxel;
}
