// Whether a lattice point in a V_bnd voxel lies inside a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4): by walks along axes, voxel by voxel. One loop does all of it, a voxel or a
// triangle a turn, so that invocations side by side do not wait for each other's inner loops.
// The including shader has what lib/body.glsl asks for and frame_state (writable).
#ifndef PALPATE_LIB_BODY_WALKS
#define PALPATE_LIB_BODY_WALKS
#include "shaders/lib/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/segment.glsl"

// What the way from one point to another crosses of a triangle, after a look at its box: a perturbed segment
// that crosses it touches its closed box.
int32_t body_crossing(ivec3 from, ivec3 to, uint32_t id) {
  const uvec3 corners = body_triangles[id];
  const ivec3 a = body_vertices[corners.x], b = body_vertices[corners.y], c = body_vertices[corners.z];
  if (any(greaterThan(min(min(a, b), c), max(from, to))) || any(lessThan(max(max(a, b), c), min(from, to))))
    return 0;
  return segment_crossing(from, to, a, b, c);
}

// A body that is not closed: what most of six walks from the voxel's middle say, and what lies between it and
// the point. Sheets do not count.
bool body_walks_inside(ivec3 point, ivec3 home) {
  const ivec3 middle = BODY_GRID.origin + BODY_GRID.size * home + ivec3(BODY_GRID.size / 2);
  const uint32_t first = body_boundary_index(home);
  int32_t between = 0;
  if (point != middle)
    for (uint32_t i = body_list_begin[first]; i < body_list_begin[first + 1u] && !spent(1u); ++i)
      if (body_bounds_solid(body_list[i])) between += body_crossing(point, middle, body_list[i]);
  // Inside where four of six walks say that the point is in a shell.
  uint32_t inside = 0u, way = 0u, entry = 0u, last = 0u;
  int32_t net = between;
  ivec3 voxel = home, from = middle, to = middle;
  while (way < 6u && !spent(1u)) {
    if (entry < last) {
      const uint32_t id = body_list[entry++];
      if (body_bounds_solid(id)) net += body_crossing(from, to, id);
      continue;
    }
    const uint32_t boundary = body_boundary_index(voxel);
    if (boundary == kNoVoxel) {
      if (net + (body_class_of(voxel) == kVoxelInternal ? 1 : 0) > 0) ++inside;
      ++way;
      net = between;
      voxel = home;
      to = middle;
      continue;
    }
    const int axis = int(way >> 1);
    const int32_t up = int32_t(way & 1u);
    from = to;
    to[axis] = BODY_GRID.origin[axis] + BODY_GRID.size * (voxel[axis] + up);
    if (from != to) {
      entry = body_list_begin[boundary];
      last = body_list_begin[boundary + 1u];
    }
    voxel[axis] += 2 * up - 1;
  }
  return inside > 3u;
}

// A closed body: whether the winding is not 0, from a walk out of it the shortest way, at whose end it is 0.
bool body_winding_inside(ivec3 point, ivec3 home) {
  uint32_t way = 0u, entry = 0u, last = 0u;
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
    if (entry < last) {
      winding += body_crossing(from, to, body_list[entry++]);
      continue;
    }
    const uint32_t boundary = body_boundary_index(voxel);
    if (boundary == kNoVoxel && body_class_of(voxel) == kVoxelExternal) break;
    from = to;
    to[axis] = BODY_GRID.origin[axis] + BODY_GRID.size * (voxel[axis] + up);
    if (boundary != kNoVoxel && from != to) {
      entry = body_list_begin[boundary];
      last = body_list_begin[boundary + 1u];
    }
    voxel[axis] += 2 * up - 1;
  }
  return winding != 0;
}
#endif
