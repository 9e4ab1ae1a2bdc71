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
#include "shaders/lib/body/listed_crossings.glsl"
#include "shaders/lib/tool_record.glsl"

// Corners of an entry of the lists at the pose. All count.
bool posed_corners(uint32_t entry, bool sheets, out ivec3 a, out ivec3 b, out ivec3 c) {
  const RecordCorners t = record_at(fine_places[entry]);
  a = world_from_tool(t.a);
  b = world_from_tool(t.b);
  c = world_from_tool(t.c);
  return true;
}

LISTED_CROSSINGS(posed_crossings, posed_corners)

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
    if (boundary != kNoVoxel && from != to) winding += posed_crossings(from, to, boundary, true);
    voxel[axis] += 2 * up - 1;
  }
  return winding;
}
#endif
