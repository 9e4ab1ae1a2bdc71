// The winding of the closed tool at its pose round a world lattice point in a V_bnd voxel of its fine
// partition: what a walk out of the tool crosses, along an axis of that grid, from voxel to voxel, and each
// voxel lists all that may be crossed in it. Shared out as in lib/body/body_walks.glsl.
// The including shader has what lib/body/body.glsl asks for, of the tool and its fine partition, and
// tool_records (TEXELS), fine_places and fine_exit (WORDS), frame_input, frame_state (writable).
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
  const RecordCorners t = record_at(fine_places(entry));
  a = world_from_tool(t.a);
  b = world_from_tool(t.b);
  c = world_from_tool(t.c);
  return true;
}

bool posed_step(inout Walk walk, out uint32_t boundary) {
  boundary = body_boundary_index(walk.voxel);
  if (boundary == kNoVoxel && body_class_of(walk.voxel) == kVoxelExternal) return false;
  walk.from = walk.to;
  walk.at[walk.axis] = BODY_GRID.origin[walk.axis] + BODY_GRID.size * (walk.voxel[walk.axis] + walk.up);
  walk.to = world_from_tool(walk.at);
  walk.voxel[walk.axis] += 2 * walk.up - 1;
  return true;
}

LISTED_CROSSINGS(posed_crossings, posed_corners, posed_step)

int32_t tool_winding(ivec3 point) {
  const ivec3 at = tool_from_world(point), voxel = body_voxel_of(at);
  const uint32_t exit = fine_exit(body_boundary_index(voxel));
  return posed_crossings(Walk(point, point, voxel, at, int(exit >> 1), int32_t(exit & 1u)), true);
}
#endif
