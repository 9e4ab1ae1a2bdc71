// Whether a lattice point in a V_bnd voxel lies inside a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4). A team goes the same way; each invocation counts its share of what a voxel
// lists, and team_sum() tells.
// The including shader has what lib/body/body.glsl asks for, int32_t body_shells[] and frame_state (writable).
#ifndef PALPATE_LIB_BODY_WALKS
#define PALPATE_LIB_BODY_WALKS
#include "shaders/lib/body/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/lib/segment_estimate.glsl"
#include "shaders/lib/team.glsl"

// Corners of a body's triangle.
void body_corners(uint32_t id, out ivec3 a, out ivec3 b, out ivec3 c) {
  const uvec3 corners = body_triangles[id];
  a = body_vertices[corners.x];
  b = body_vertices[corners.y];
  c = body_vertices[corners.z];
}

// Σ of what the way from one point to another crosses of the invocation's share of what a voxel lists;
// `sheets`: of those in sheets, too. Floats say it first, for llvmpipe runs exact tests for all lanes that
// stand side by side as soon as one asks: what they leave open, a bit each, is then asked by itself.
int32_t body_crossings(ivec3 from, ivec3 to, uint32_t boundary, bool sheets) {
  const ivec3 low = min(from, to), high = max(from, to);
  const uint32_t last = body_list_begin[boundary + 1u];
  int32_t net = 0;
  for (uint32_t first = body_list_begin[boundary] + team_part(); first < last && !spent(1u); first += 32u * LANES) {
    uint32_t unsure = 0u;
    ivec3 a, b, c;
    for (uint32_t i = 0u; i < 32u && first + i * LANES < last && !spent(1u); ++i) {
      const uint32_t id = body_list[first + i * LANES];
      if (!sheets && !body_bounds_solid(id)) continue;
      body_corners(id, a, b, c);
      // A perturbed segment that crosses a triangle touches its closed box.
      if (any(greaterThan(min(min(a, b), c), high)) || any(lessThan(max(max(a, b), c), low))) continue;
      const int32_t crossing = segment_estimate(from, to, a, b, c);
      if (crossing == kUnsure) unsure |= 1u << i;
      else net += crossing;
    }
    while (unsure != 0u && !spent(1u)) {
      body_corners(body_list[first + uint32_t(findLSB(unsure)) * LANES], a, b, c);
      unsure &= unsure - 1u;
      net += segment_crossing(from, to, a, b, c);
    }
  }
  return net;
}

// A body that is not closed: the point is inside where the team's sum is above 0. In how many shells the
// voxel's middle is, as preparation has asked six walks (compute/gpu/prepare/shells.cpp), and what lies
// between it and the point. Sheets do not count.
int32_t body_shells_at(ivec3 point, ivec3 home) {
  const ivec3 middle = BODY_GRID.origin + BODY_GRID.size * home + ivec3(BODY_GRID.size / 2);
  const uint32_t boundary = body_boundary_index(home);
  return (speaks() ? body_shells[boundary] : 0) +
         (point == middle ? 0 : body_crossings(point, middle, boundary, false));
}

// A closed body: the point is inside where the team's sum, the winding, is not 0; from a walk out of it the
// shortest way, at whose end it is 0.
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
