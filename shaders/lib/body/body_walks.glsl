// Whether a lattice point in a V_bnd voxel lies inside a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4). A team goes the same way; each invocation counts its share of what a voxel
// lists, and team_sum() tells.
// The including shader has what lib/body/body.glsl asks for, WORDS body_shells and frame_state (writable).
#ifndef PALPATE_LIB_BODY_WALKS
#define PALPATE_LIB_BODY_WALKS
#include "shaders/lib/body/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/body/listed_crossings.glsl"

// Corners of an entry of the lists. False: it does not count. `sheets`: those of sheets do.
bool body_corners(uint32_t entry, bool sheets, out ivec3 a, out ivec3 b, out ivec3 c) {
  const uint32_t id = body_list(entry);
  if (!sheets && !body_bounds_solid(id)) return false;
  const uvec3 corners = body_triangles(id);
  a = body_vertices(corners.x);
  b = body_vertices(corners.y);
  c = body_vertices(corners.z);
  return true;
}

// To the next face on the way out of the body.
bool body_step(inout Walk walk, out uint32_t boundary) {
  boundary = body_boundary_index(walk.voxel);
  if (boundary == kNoVoxel && body_class_of(walk.voxel) == kVoxelExternal) return false;
  walk.from = walk.to;
  walk.to[walk.axis] =
      BODY_GRID.origin[walk.axis] + BODY_GRID.size * (walk.voxel[walk.axis] + walk.up);
  walk.voxel[walk.axis] += 2 * walk.up - 1;
  return true;
}

LISTED_CROSSINGS(body_crossings, body_corners, body_step)

// A single piece, from `from` to `at`.
bool only_step(inout Walk walk, out uint32_t boundary) {
  boundary = body_boundary_index(walk.voxel);
  const bool first = walk.to != walk.at;
  walk.to = walk.at;
  return first;
}

LISTED_CROSSINGS(shell_crossings, body_corners, only_step)

// Whether the point is inside, by the team's sum: the winding about a closed body, else the shells (below).
bool body_says_inside(bool closed, int32_t sum) { return closed ? sum != 0 : sum > 0; }

// A body that is not closed. In how many shells the voxel's middle is, as preparation has asked six walks (compute/gpu/prepare/shells.cpp), and what lies
// between it and the point. Sheets do not count.
int32_t body_shells_at(ivec3 point, ivec3 home) {
  const ivec3 middle = BODY_GRID.origin + BODY_GRID.size * home + ivec3(BODY_GRID.size / 2);
  return (speaks() ? body_shells(body_boundary_index(home)) : 0) +
         shell_crossings(Walk(point, point, home, middle, 0, 0), false);
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
  return body_crossings(Walk(point, point, home, point, int(way >> 1), int32_t(way & 1u)), true);
}
#endif
