// The winding of the closed tool at its pose round a world lattice point in a V_bnd voxel of its fine
// partition: what a walk out of the tool crosses, along an axis of that grid, from voxel to voxel, and each
// voxel lists all that may be crossed in it. Shared out as in lib/body/body_walks.glsl.
// The including shader has what lib/body/body.glsl asks for, of the tool and its fine partition, and
// tool_records[], fine_places[], fine_exit[], frame_input, frame_state (writable).
//
// The walk's points on the faces between voxels are lattice points of the tool, moved to the world and
// rounded. That, the rounding of the sample and that of the triangles' corners come to less than two steps,
// and voxels are grown by kToolVoxelGrowth; so a voxel's list holds all that the walk crosses in it, and at
// the face of a V_ext voxel the winding is 0.
#ifndef PALPATE_LIB_TOOL_WINDING
#define PALPATE_LIB_TOOL_WINDING
#include "shaders/lib/body/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/segment.glsl"
#include "shaders/lib/segment_estimate.glsl"
#include "shaders/lib/team.glsl"
#include "shaders/lib/tool_record.glsl"

// Corners of an entry of the lists at the pose.
void posed_corners(uint32_t entry, out ivec3 a, out ivec3 b, out ivec3 c) {
  const RecordCorners t = record_at(fine_places[entry]);
  a = world_from_tool(t.a);
  b = world_from_tool(t.b);
  c = world_from_tool(t.c);
}

// Σ of what the way from one point to another crosses of the invocation's share of what a voxel lists: as
// body_crossings().
int32_t posed_crossings(ivec3 from, ivec3 to, uint32_t boundary) {
  const ivec3 low = min(from, to), high = max(from, to);
  const uint32_t last = body_list_begin[boundary + 1u];
  int32_t net = 0;
  for (uint32_t first = body_list_begin[boundary] + team_part(); first < last && !spent(1u); first += 32u * LANES) {
    uint32_t unsure = 0u;
    ivec3 a, b, c;
    for (uint32_t i = 0u; i < 32u && first + i * LANES < last && !spent(1u); ++i) {
      posed_corners(first + i * LANES, a, b, c);
      if (any(greaterThan(min(min(a, b), c), high)) || any(lessThan(max(max(a, b), c), low))) continue;
      const int32_t crossing = segment_estimate(from, to, a, b, c);
      if (crossing == kUnsure) unsure |= 1u << i;
      else net += crossing;
    }
    while (unsure != 0u && !spent(1u)) {
      posed_corners(first + uint32_t(findLSB(unsure)) * LANES, a, b, c);
      unsure &= unsure - 1u;
      net += segment_crossing(from, to, a, b, c);
    }
  }
  return net;
}

int32_t tool_winding(ivec3 point) {
  ivec3 from = point, to = point, at = tool_from_world(point);
  ivec3 voxel = body_voxel_of(at);
  const uint32_t exit = fine_exit[body_boundary_index(voxel)];
  const int axis = int(exit >> 1);
  const int32_t up = int32_t(exit & 1u);
  int32_t winding = 0;
  while (!spent(1u)) {
    const uint32_t boundary = body_boundary_index(voxel);
    if (boundary == kNoVoxel && body_class_of(voxel) == kVoxelExternal) break;
    from = to;
    at[axis] = BODY_GRID.origin[axis] + BODY_GRID.size * (voxel[axis] + up);
    to = world_from_tool(at);
    if (boundary != kNoVoxel && from != to) winding += posed_crossings(from, to, boundary);
    voxel[axis] += 2 * up - 1;
  }
  return winding;
}
#endif
