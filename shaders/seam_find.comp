// One invocation: an entry of a voxel's list, from `first` on, and, behind it in the list, the kSeamSpan entries of round `round`. Appends the
// pairs that may touch along a seam under a smooth angle: boxes meet (in tenths of the voxel, then exactly), no common edge, unit normals near enough (the host
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
layout(scalar, set = 0, binding = 7) readonly buffer Boxes { uint32_t boxes[]; };   // of seam_box
layout(scalar, set = 0, binding = 8) readonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(push_constant, scalar) uniform Push { SeamPush push; };

Triangle load(uvec3 corner) { return Triangle(vertices[corner.x], vertices[corner.y], vertices[corner.z]); }

bool boxes_share(uint32_t a, uint32_t b) {
  uint32_t both = a & b;
  return (both & 0x3FFu) != 0u && (both & 0xFFC00u) != 0u && (both & 0x3FF00000u) != 0u;
}

void main() {
  uint32_t entry = item_index();
  if (entry >= push.count) return;
  entry += push.first;
  uint32_t end = list_begin[entry_voxel[entry] + 1u];
  uint32_t first = entry + 1u + push.round * kSeamSpan;
  if (first >= end) return;
  end = min(end, first + kSeamSpan);
  uint32_t s = list_triangles[entry];
  uvec3 of_s = triangles[s];
  Triangle at_s = load(of_s);
  ivec3 normal = unit_normal[s];
  uint32_t box = boxes[entry];
  for (uint32_t i = first; i < end; ++i) {
    // First to the next one whose box meets; so that invocations that run together do the rest together.
    while (i < end && !boxes_share(box, boxes[i])) ++i;
    if (i == end) break;
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
