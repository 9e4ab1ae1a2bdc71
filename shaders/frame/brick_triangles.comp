#version 460
#extension GL_GOOGLE_include_directive : require
// Which triangles of a cluster touch a brick, exactly. A workgroup a ClusterBrick, an invocation one of the cluster's triangles.
// Reads tool_world, mobile_state; appends triangle_bricks; a brick that is all V_int settles kMobileInternal here.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "shaders/lib/voxel_range.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolOrder, uint32_t, tool_order);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindClusterBricks, ClusterBrick, cluster_bricks);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindTriangleBricks, TriangleBrick, triangle_bricks);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"

void main() {
  const uint32_t item = flat_group();
  if (item >= frame_lists[kListClusterBricks].count) return;
  const ClusterBrick work = cluster_bricks[item];
  const uint32_t place = work.cluster * kClusterSize + gl_LocalInvocationIndex;
  if (place >= scene.tool.triangles) return;
  const uint32_t mobile = tool_order[place];
  if ((mobile_state[mobile] & kMobileVoid) != 0u) return;

  const uvec3 t = tool_triangles[mobile];
  const ivec3 a = tool_world[t.x], b = tool_world[t.y], c = tool_world[t.z];
  const int32_t side = scene.mockup.grid.size * 8;
  const ivec3 low = scene.mockup.grid.origin + side * brick_at(work.brick, scene.mockup.grid.bricks);
  if (!triangle_touches_box(a, b, c, raw_normal(a, b, c), low, low + side)) return;
  if (mockup_brick_slot[work.brick] == kBrickInternal) mark_mobile(mobile, kMobileInternal);
  const uint32_t at = take_room(kListTriangleBricks, 1u);
  if (at < frame_lists[kListTriangleBricks].capacity) triangle_bricks[at] = TriangleBrick(mobile, work.brick);
}
