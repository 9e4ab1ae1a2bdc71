// One invocation: an entry of a voxel's list and, behind it in the list, the kRankSpan entries of round `round`. Appends the
// pairs that may touch along a seam under a smooth angle: boxes meet, no common edge, unit normals near enough (the host
// decides exactly), and two with one common corner only where that is not easily seen to be all they share. A pair is found
// once in each voxel that both touch. `found` counts all, written or not.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/lib/seam.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer UnitNormal { ivec3 unit_normal[]; };
layout(scalar, set = 0, binding = 3) readonly buffer ListBegin { uint32_t list_begin[]; };
layout(scalar, set = 0, binding = 4) readonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 5) buffer Found { uint32_t found; };
layout(scalar, set = 0, binding = 6) writeonly buffer Pairs { uvec2 pairs[]; };
layout(push_constant, scalar) uniform Push { SeamPush push; };

#define LIST_BEGIN list_begin
#include "shaders/lib/list_of_entry.glsl"

Triangle load(uvec3 corner) { return Triangle(vertices[corner.x], vertices[corner.y], vertices[corner.z]); }

void main() {
  uint32_t entry = item_index();
  if (entry >= push.count) return;
  uint32_t end = list_begin[list_of_entry(entry, push.voxels) + 1u];
  uint32_t first = entry + 1u + push.round * kRankSpan;
  if (first >= end) return;
  end = min(end, first + kRankSpan);
  uint32_t s = list_triangles[entry];
  uvec3 of_s = triangles[s];
  Triangle at_s = load(of_s);
  ivec3 normal = unit_normal[s];
  for (uint32_t i = first; i < end; ++i) {
    uint32_t t = list_triangles[i];
    ivec3 other = unit_normal[t];
    if (mul_wide(normal.x, other.x) + mul_wide(normal.y, other.y) + mul_wide(normal.z, other.z) < push.least_cosine) continue;
    uvec3 of_t = triangles[t];
    Triangle at_t = load(of_t);
    if (!boxes_meet(at_s, at_t) || share_an_edge(of_s, of_t) || meet_in_a_corner_alone(at_s, at_t, of_s, of_t)) continue;
    uint32_t at = atomicAdd(found, 1u);
    if (at < push.capacity) pairs[at] = uvec2(s, t);
  }
}
