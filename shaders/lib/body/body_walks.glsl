// Whether a lattice point in a V_bnd voxel lies inside a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4). A team goes the same way; each invocation counts its share of what a voxel
// lists, and team_sum() tells.
// The including shader has what lib/body/body.glsl asks for, int32_t body_shells[] and frame_state (writable).
#ifndef PALPATE_LIB_BODY_WALKS
#define PALPATE_LIB_BODY_WALKS
#include "shaders/lib/body/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/body/listed_crossings.glsl"

// Corners of an entry of the lists. False: it does not count. `sheets`: those of sheets do.
bool body_corners(uint32_t entry, bool sheets, out ivec3 a, out ivec3 b, out ivec3 c) {
  const uint32_t id = body_list[entry];
  if (!sheets && !body_bounds_solid(id)) return false;
  const uvec3 corners = body_triangles[id];
  a = body_vertices[corners.x];
  b = body_vertices[corners.y];
  c = body_vertices[corners.z];
  return true;
}

LISTED_CROSSINGS(body_crossings, body_corners)

// Whether the point is inside, by the team's sum: the winding about a closed body, else the shells (below).
bool body_says_inside(bool closed, int32_t sum) { return closed ? sum != 0 : sum > 0; }

// A body that is not closed. In how many shells the voxel's middle is, as preparation has asked six walks (compute/gpu/prepare/shells.cpp), and what lies
// between it and the point. Sheets do not count.
int32_t body_shells_at(ivec3 point, ivec3 home) {
  const ivec3 middle = BODY_GRID.origin + BODY_GRID.size * home + ivec3(BODY_GRID.size / 2);
  const uint32_t boundary = body_boundary_index(home);
  return (speaks() ? body_shells[boundary] : 0) +
         (point == middle ? 0 : body_crossings(point, middle, boundary, false));
}

// A closed body: the winding, from a walk out of it the shortest way, at whose end it is 0.
int32_t body_winding(ivec3 point, ivec3 home) {
  uint32_t way = 0u;
  for (int32_t ring = 1; way < 6u && !spent(1u);) {   // the grid's outermost layer is V_ext, so it ends
    ivec3 there = home;
    there[int(way >> 1)] += (way & 1u) != 0u ? ring : -ring;
    if (body_class_of(there) == kVoxelExternal) break;
    if (++way == 6u) {
      way = 0u;
      ++ring;
    }
  }
  const int axis = int(way >> 1);
  const int32_t up = int32_t(way & 1u);
  int32_t winding = 0;
  ivec3 voxel = home, from = point, to = point;
  while (!spent(1u)) {
    const uint32_t boundary = body_boundary_index(voxel);
    if (boundary == kNoVoxel && body_class_of(voxel) == kVoxelExternal) break;
    from = to;
    to[axis] = BODY_GRID.origin[axis] + BODY_GRID.size * (voxel[axis] + up);
    if (boundary != kNoVoxel && from != to) winding += body_crossings(from, to, boundary, true);
    voxel[axis] += 2 * up - 1;
  }
  return winding;
}
#endif
