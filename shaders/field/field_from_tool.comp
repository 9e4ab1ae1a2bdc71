#version 460
// LANES invocations: a sample of a triangle of C_m in a V_bnd or V_int voxel of the mock-up, or an extra one.
// Where it lies inside, adds how the mock-up's depth there pushes.
// Reads tool_points, both bodies, the mock-up's partition. Writes field_work, ignored patches.
// Before: field_points; the list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool CLOSED = true;   // the mock-up
layout(constant_id = 1) const bool INSIDE = true;   // the tool has an inside
layout(constant_id = 2) const bool SHEETS = true;   // some of its samples are a sheet's

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindToolPoints, FieldPoint, tool_points);
WORDS(kBindToolInfo, uint32_t, tool_info)
TRIPLES(kBindToolNormals, ivec3, tool_normals)
TRIPLES(kBindToolVertices, ivec3, tool_vertices)
TRIPLES(kBindToolTriangles, uvec3, tool_triangles)
READ(kBindMobileState, uint32_t, mobile_state);
TRIPLES(kBindMockupVertices, ivec3, body_vertices)
TRIPLES(kBindMockupTriangles, uvec3, body_triangles)
WORDS(kBindMockupInfo, uint32_t, body_info)
TRIPLES(kBindMockupNormals, ivec3, body_normals)
TEXELS(kBindMockupTree, body_tree)
WORDS(kBindMockupPatches, uint32_t, mockup_patches)
WORDS(kBindMockupBrickSlot, uint32_t, body_brick_slot)
WORDS(kBindMockupBricks, uint32_t, body_bricks)
WORDS(kBindMockupListBegin, uint32_t, body_list_begin)
WORDS(kBindMockupListTriangles, uint32_t, body_list)
WORDS(kBindMockupShells, int32_t, body_shells)
EDIT(kBindFieldWork, int64_t, field_work);
EDIT(kBindCarrierWork, int64_t, carrier_work);
READ(kBindIgnored, uint32_t, ignored);
EDIT(kBindIgnoredState, uint32_t, ignored_state);
EDIT(kBindResultIgnored, uint32_t, result_ignored);

#define BODY_GRID scene.mockup.grid
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(mobile, kBindMobileKeys)
#include "shaders/lib/pose.glsl"
#include "shaders/lib/body/body_depth.glsl"
#include "shaders/lib/body/body_doubt.glsl"
#include "shaders/lib/body/body_walks.glsl"
#include "shaders/lib/field_sums.glsl"
#include "shaders/lib/ignored.glsl"

// The invocation's part of a sum that is not 0 where the point is inside a closed mock-up, and above 0 where it
// is inside one that is not.
int32_t inside_mockup(ivec3 point) {
  const ivec3 voxel = body_voxel_of(point);
  const uint32_t voxel_class = body_class_of(voxel);
  if (voxel_class != kVoxelBoundary) return speaks() && voxel_class == kVoxelInternal ? 1 : 0;
  return CLOSED ? body_winding(point, voxel) : body_shells_at(point, voxel);
}

int32_t inside_mockup(FieldPoint work) {
  take_pose(mobile_pose(work.triangle));
  // What touches nothing is on one side of a closed mock-up, with its first corner.
  const bool own = !CLOSED || (mobile_state[work.triangle] & kMobileHit) != 0u;
  return inside_mockup(own ? work.point
                           : world_from_tool(tool_vertices(tool_triangles(mobile_id(work.triangle)).x)));
}

// False: nothing pushes.
bool push_of(FieldPoint work, int32_t shells, Depth depth, out Push push) {
  const uint32_t mobile = mobile_id(work.triangle);
  if (depth.triangle == kNone || is_ignored(depth.triangle)) return false;
  push.at = work.point;
  push.against = body_normals(depth.triangle);
  push.sheet = SHEETS && (!INSIDE || (tool_info(mobile) & kInfoSheet) != 0u);
  if (SHEETS) {
    const uvec3 corners = body_triangles(depth.triangle);
    const ivec3 out_of = way_out(uint32_t(depth.steps), push.against, body_vertices(corners.x),
                                 body_vertices(corners.y), body_vertices(corners.z), work.point);
    if (push.sheet) push.against = out_of;
  }
  push.along = push.sheet ? push.against : -turned(tool_normals(mobile));
  push.depth = uint32_t(depth.steps);
  push.weight = work.weight;
  const bool thin = (tool_info(mobile) & kInfoThin) != 0u,
             in_thin = (body_info(depth.triangle) & kInfoThin) != 0u;
  push.counted = push.sheet || (thin && !in_thin) ? work.weight
                 : thin == in_thin               ? work.weight >> 1
                                                 : 0u;
  if (!CLOSED) push.counted = body_sure(push.counted, work.point, shells);
  push.static_id = depth.triangle;
  push.mobile = mobile;
  push.slot = kNone;
  return true;
}

void main() {
  const uint32_t item = team_item();
  FieldPoint work;
  int32_t sum = 0;
  if (item < list_count(kListToolPoints)) {
    work = tool_points[item];
    sum = inside_mockup(work);
  }
  sum = team_sum(sum);
  const bool inside = body_says_inside(CLOSED, sum);
  const Depth depth = body_depth(inside, work.point);
  Push push;
  const bool pushes = inside && speaks() && push_of(work, sum, depth, push);
  add_pushes(pushes, push);
  tell_spent();
}
