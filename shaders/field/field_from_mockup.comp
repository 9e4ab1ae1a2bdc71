#version 460
// LANES invocations: a sample of the mock-up inside the tool that weighs something, or an extra one, which is
// asked first whether it lies there. Adds how the tool's depth there pushes.
// Reads mockup_points, both bodies, the tool's fine partition. Writes field_work, carrier_work, ignored patches.
// Before: field_points; the list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool CLOSED = true;   // the tool
layout(constant_id = 1) const bool SHEETS = true;   // some of the mock-up's samples are a sheet's
layout(constant_id = 2) const bool INSIDE = true;   // the mock-up has an inside

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindMockupPoints, FieldPoint, mockup_points);
WORDS(kBindMockupInfo, uint32_t, mockup_info)
TRIPLES(kBindMockupNormals, ivec3, mockup_normals)
WORDS(kBindMockupPatches, uint32_t, mockup_patches)
READ(kBindStaticState, uint32_t, static_state);
READ(kBindStaticSlot, uint32_t, static_slot);
TEXELS(kBindToolRecords, tool_records)
TRIPLES(kBindToolVertices, ivec3, body_vertices)
TRIPLES(kBindToolTriangles, uvec3, body_triangles)
WORDS(kBindToolInfo, uint32_t, body_info)
TRIPLES(kBindToolNormals, ivec3, body_normals)
TEXELS(kBindToolTree, body_tree)
WORDS(kBindFineBrickSlot, uint32_t, body_brick_slot)
WORDS(kBindFineBricks, uint32_t, body_bricks)
WORDS(kBindFineListBegin, uint32_t, body_list_begin)
WORDS(kBindFineListTriangles, uint32_t, body_list)
WORDS(kBindFineShells, int32_t, body_shells)
WORDS(kBindFinePlaces, uint32_t, fine_places)
WORDS(kBindFineExit, uint32_t, fine_exit)
EDIT(kBindFieldWork, int64_t, field_work);
EDIT(kBindCarrierWork, int64_t, carrier_work);
READ(kBindIgnored, uint32_t, ignored);
EDIT(kBindIgnoredState, uint32_t, ignored_state);
EDIT(kBindResultIgnored, uint32_t, result_ignored);

#define BODY_GRID scene.fine
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(static, kBindStaticKeys)
#include "shaders/lib/body/body_depth.glsl"
#include "shaders/lib/body/body_doubt.glsl"
#include "shaders/lib/body/body_walks.glsl"
#include "shaders/lib/field_sums.glsl"
#include "shaders/lib/ignored.glsl"
#include "shaders/lib/tool_winding.glsl"

// The invocation's part of a sum that is not 0 where the point is inside a closed tool, and above 0 where it is
// inside one that is not.
int32_t inside_tool(ivec3 point, ivec3 at) {
  const ivec3 voxel = body_voxel_of(at);
  const uint32_t voxel_class = body_class_of(voxel);
  if (voxel_class != kVoxelBoundary) return speaks() && voxel_class == kVoxelInternal ? 1 : 0;
  return CLOSED ? tool_winding(point) : body_shells_at(at, voxel);
}

struct Asked {
  ivec3 point, at;   // world lattice, tool lattice
  uint32_t entry, id, weight;
};

// The invocation's part of a sum as above, of what counts if it lies inside. (Of a grid sample, which does,
// nobody asks where it doesn't matter how many shells it is in.)
int32_t ask(FieldPoint work, out Asked asked) {
  asked.point = work.point;
  asked.entry = work.triangle & ~kExtraPoint;
  asked.id = static_id(asked.entry);
  asked.weight = work.weight;
  take_pose(static_pose(asked.entry));
  asked.at = tool_from_world(asked.point);
  if ((work.triangle & kExtraPoint) == 0u && (CLOSED || !body_doubted(body_voxel_of(asked.at))))
    return speaks() ? 1 : 0;
  return inside_tool(asked.point, asked.at);
}

// False: nothing pushes.
bool push_of(Asked asked, int32_t shells, Depth depth, out Push push) {
  const uint32_t entry = asked.entry, id = asked.id, weight = asked.weight;
  if (depth.triangle == kNone || is_ignored(id)) return false;
  push.at = asked.point;
  push.against = -turned(body_normals(depth.triangle));
  push.sheet = SHEETS && (!INSIDE || (mockup_info(id) & kInfoSheet) != 0u);
  if (SHEETS) {
    const uvec3 corners = body_triangles(depth.triangle);
    const ivec3 out_of = way_out(uint32_t(depth.steps), body_normals(depth.triangle), body_vertices(corners.x),
                                 body_vertices(corners.y), body_vertices(corners.z), asked.at);
    if (push.sheet) push.against = -turned(out_of);
  }
  push.along = push.sheet ? push.against : mockup_normals(id);
  push.depth = uint32_t(depth.steps);
  push.weight = weight;
  const bool thin = (mockup_info(id) & kInfoThin) != 0u,
             in_thin = (body_info(depth.triangle) & kInfoThin) != 0u;
  push.counted = push.sheet || (thin && !in_thin) ? weight
                 : thin == in_thin               ? weight >> 1
                                                 : 0u;
  if (!CLOSED) push.counted = body_sure(push.counted, asked.at, shells);
  push.static_id = id;
  push.mobile = depth.triangle;
  // CST and EST carry.
  push.slot = (static_state[entry] & (kStaticHit | kStaticSampled)) != 0u ? static_slot[entry] : kNone;
  return true;
}

void main() {
  const uint32_t item = team_item();
  Asked asked;
  const int32_t sum = team_sum(item < list_count(kListMockupPoints) ? ask(mockup_points[item], asked) : 0);
  const bool counts = body_says_inside(CLOSED, sum);
  const Depth depth = body_depth(counts, asked.at);
  Push push;
  const bool pushes = counts && speaks() && push_of(asked, sum, depth, push);
  add_pushes(pushes, push);
  tell_spent();
}
