// One invocation: an entry of a voxel's list. Writes the part of the voxel that the triangle's box takes, in tenths along
// each axis: bits 0–9 for x, 10–19 for y, 20–29 for z. Triangles that meet in the voxel have a bit in common on every axis,
// because both have the tenth that holds the common point: rounding moves that point, but the same way for both.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(scalar, set = 0, binding = 3) readonly buffer List { uint32_t list_triangles[]; };
layout(scalar, set = 0, binding = 4) readonly buffer BoundaryPlace { uint32_t boundary_place[]; };
layout(scalar, set = 0, binding = 5) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 6) writeonly buffer Boxes { uint32_t boxes[]; };
layout(push_constant, scalar) uniform Push { GridPush push; };

void main() {
  uint32_t entry = item_index();
  if (entry >= push.count) return;
  uint32_t place = boundary_place[entry_voxel[entry]];
  ivec3 voxel = cell_of_number(mixed_brick[place >> 9], push.bricks) * 8 +
                ivec3(int32_t(place & 7u), int32_t(place >> 3 & 7u), int32_t(place >> 6 & 7u));
  uvec3 corner = triangles[list_triangles[entry]];
  ivec3 a = vertices[corner.x], b = vertices[corner.y], c = vertices[corner.z];
  ivec3 base = push.origin + voxel * push.size;
  ivec3 lo = max(min(a, min(b, c)) - base, 0), hi = min(max(a, max(b, c)) - base, push.size);
  uint32_t mask = 0u;
  float tenths = 10.0 / float(push.size);
  uvec3 first = uvec3(min(vec3(lo) * tenths, vec3(9.0))), last = uvec3(min(vec3(hi) * tenths, vec3(9.0)));
  for (int k = 0; k < 3; ++k) mask |= ((2u << last[k]) - (1u << first[k])) << (10 * k);
  boxes[entry] = mask;
}
