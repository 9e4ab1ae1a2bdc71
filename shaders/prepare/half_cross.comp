// One invocation: a pair (triangle, boundary voxel). Does the way through the voxel along `axis`, by its
// middle, cross the triangle? Adds the crossing's sign to halves[2 · voxel + 1] beyond the middle, to
// halves[2 · voxel] before it. Sheets bound nothing. Before: halves are 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer Info { uint32_t info[]; };
layout(scalar, set = 0, binding = 3) readonly buffer PairTriangle { uint32_t pair_triangle[]; };
layout(scalar, set = 0, binding = 4) readonly buffer PairVoxel { uint32_t pair_voxel[]; };
layout(scalar, set = 0, binding = 5) readonly buffer BoundaryPlace { uint32_t boundary_place[]; };
layout(scalar, set = 0, binding = 6) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 7) buffer Halves { int32_t halves[]; };
layout(push_constant, scalar) uniform Push { GridPush push; };

void main() {
  const uint32_t pair = item_index();
  if (pair >= push.count) return;
  const uint32_t triangle = pair_triangle[pair], voxel = pair_voxel[pair], place = boundary_place[voxel];
  if ((info[triangle] & (kInfoCollapsed | kInfoSheet)) != 0u) return;
  const ivec3 at = cell_of_number(mixed_brick[place >> 9], push.bricks) * 8 +
                   ivec3(int32_t(place & 7u), int32_t(place >> 3 & 7u), int32_t(place >> 6 & 7u));
  const ivec3 middle = push.origin + at * push.size + push.size / 2;
  ivec3 reach = ivec3(0);
  reach[push.axis] = push.size / 2;
  const uvec3 corners = triangles[triangle];
  const ivec3 a = vertices[corners.x], b = vertices[corners.y], c = vertices[corners.z];
  const int32_t crossing = segment_crossing(middle - reach, middle + reach, a, b, c);
  if (crossing == 0) return;
  // It leaves, or enters, behind the middle where that is still on the side of the beginning.
  const bool beyond = plane_ahead(raw_normal(a, b, c), middle, a) == crossing;
  atomicAdd(halves[2u * voxel + uint32_t(beyond)], crossing);
}
