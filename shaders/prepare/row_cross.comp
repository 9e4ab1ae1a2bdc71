// One invocation: a pair (triangle, boundary voxel). For each of the first `axis` axes: does the line through
// the voxel's centre along that axis, its point perturbed (docs/EXACTNESS.md section 1), cross the triangle
// inside this voxel? Adds the crossing's sign to crossings[voxels · axis + voxel]. Before: crossings are 0.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/lib/wide_integer.glsl"
#include "shaders/shared/prepare.h"

layout(scalar, set = 0, binding = 0) readonly buffer Vertices { ivec3 vertices[]; };
layout(scalar, set = 0, binding = 1) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = 2) readonly buffer PairTriangle { uint32_t pair_triangle[]; };
layout(scalar, set = 0, binding = 3) readonly buffer PairVoxel { uint32_t pair_voxel[]; };
layout(scalar, set = 0, binding = 4) readonly buffer BoundaryPlace { uint32_t boundary_place[]; };
layout(scalar, set = 0, binding = 5) readonly buffer MixedBrick { uint32_t mixed_brick[]; };
layout(scalar, set = 0, binding = 6) buffer Crossings { int32_t crossings[]; };
layout(push_constant, scalar) uniform Push { GridPush push; uint32_t voxels; };

// Side of the line along `axis` (u, v the next axes, cyclic) on which the edge p→q, relative to the perturbed
// point, passes: sign of e·(p×q), or of the first non-zero component of e×(q−p) in the order x, y, z.
int32_t edge_side(uint32_t axis, ivec3 p, ivec3 q) {
  uint32_t u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  int64_t area = mul_wide(p[u], q[v]) - mul_wide(p[v], q[u]);
  if (area != 0l) return sign_of(area);
  // e×f has components u: −f_v and v: f_u. Which of them comes first depends on the axis.
  int32_t along_u = -(q[v] - p[v]), along_v = q[u] - p[u];
  int32_t former = u < v ? along_u : along_v, latter = u < v ? along_v : along_u;
  return former != 0 ? sign(former) : sign(latter);
}

void main() {
  uint32_t pair = item_index();
  if (pair >= push.count) return;
  uint32_t voxel = pair_voxel[pair], place = boundary_place[voxel];
  ivec3 at = cell_of_number(mixed_brick[place >> 9], push.bricks) * 8 +
             ivec3(int32_t(place & 7u), int32_t(place >> 3 & 7u), int32_t(place >> 6 & 7u));
  ivec3 lo = push.origin + at * push.size;
  ivec3 centre = lo + push.size / 2;
  uvec3 corner = triangles[pair_triangle[pair]];
  ivec3 a = vertices[corner.x] - centre, b = vertices[corner.y] - centre, c = vertices[corner.z] - centre;
  i64vec3 n = raw_normal(a, b, c);
  for (uint32_t axis = 0u; axis < push.axis; ++axis) {
    int32_t facing = sign_of(n[axis]);
    if (facing == 0) continue;
    if (edge_side(axis, a, b) != facing || edge_side(axis, b, c) != facing || edge_side(axis, c, a) != facing)
      continue;
    // In [lower face, upper face) along the axis: the crossing lies where n·(a − x) changes sign.
    ivec3 half_step = ivec3(0);
    half_step[axis] = push.size / 2;
    if (sign_dot(n, a + half_step) * facing >= 0 && sign_dot(n, a - half_step) * facing < 0)
      atomicAdd(crossings[voxels * axis + voxel], facing);
  }
}
