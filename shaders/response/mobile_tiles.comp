#version 460
// One invocation: a member of an area. The first one of a tool triangle whose area needs mobile normals lists the tiles of
// its sample grid.
// Reads members, areas, the tool's triangles in its own frame. Writes mobile_work[].claimed, mobile tiles.
// Before: areas_first.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

CONSTANT(kBindScene, SceneConstants, scene);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindResultMembers, AreaMember, members);
READ(kBindAreas, AreaWork, areas);
EDIT(kBindMobileWork, MobileWork, mobile_work);
EDIT(kBindMobileTiles, MobileTile, mobile_tiles);
READ(kBindToolVertices, ivec3, tool_vertices);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolInfo, uint32_t, tool_info);

#include "shaders/lib/list_room.glsl"

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListMembers].count) return;
  const AreaMember member = members[i];
  if ((areas[member.area].state & kAreaWantsMobile) == 0u) return;
  if (atomicExchange(mobile_work[member.mobile].claimed, 1u) != 0u) return;

  // The box of grid points: those in it and just outside are decided one by one later.
  const uvec3 corners = tool_triangles[member.mobile];
  const ivec3 a = tool_vertices[corners.x], b = tool_vertices[corners.y], c = tool_vertices[corners.z];
  const uint32_t axis = tool_info[member.mobile] >> kInfoAxisShift & 3u;
  const uint32_t u = (axis + 1u) % 3u, v = (axis + 2u) % 3u;
  const ivec3 low = min(min(a, b), c), high = max(max(a, b), c);
  const int32_t s = scene.sample_spacing;
  const int32_t u_first = floor_div(low[u], s), u_last = floor_div(high[u], s);
  const int32_t v_first = floor_div(low[v], s), v_last = floor_div(high[v], s);
  const uint32_t across = uint32_t(u_last - u_first) / uint32_t(kMobileTile) + 1u;
  const uint32_t down = uint32_t(v_last - v_first) / uint32_t(kMobileTile) + 1u;
  if (uint64_t(across) * uint64_t(down) >= uint64_t(kLoopBudget)) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t first = take_room(kListMobileTiles, across * down);
  const uint32_t capacity = frame_lists[kListMobileTiles].capacity;
  for (uint32_t t = 0u; t < across * down && first + t < capacity; ++t)
    mobile_tiles[first + t] = MobileTile(member.mobile, u_first + kMobileTile * int32_t(t % across),
                                         v_first + kMobileTile * int32_t(t / across));
}
