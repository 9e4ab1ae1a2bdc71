#version 460
// One invocation: a tool triangle of C_m. Gives it to every area whose sphere holds its rounded centroid,
// else to the nearest.
// Reads areas, transformed vertices. Writes members, mobile_areas.
// Before: areas_gather.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindContactMobiles, uint32_t, contact_mobiles);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolVertices, ivec3, tool_vertices);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ_ONE(kBindResponseState, ResponseState, response);
READ(kBindAreas, AreaWork, areas);
EDIT(kBindMobileAreas, uint32_t, mobile_areas);
EDIT(kBindResultMembers, AreaMember, members);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/centroid.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/area_sphere.glsl"

void append(uint32_t area, uint32_t mobile) {
  const uint32_t i = take_room(kListMembers, 1u);
  if (i < frame_lists[kListMembers].capacity) members[i] = AreaMember(area, mobile);
}

void main() {
  const uint32_t i = flat_invocation();
  if (i >= frame_lists[kListContactMobiles].count) return;
  const uint32_t mobile = contact_mobiles[i];
  const uvec3 corners = tool_triangles[mobile];
  const ivec3 g =
      rounded_centroid(world_from_tool(tool_vertices[corners.x]), world_from_tool(tool_vertices[corners.y]),
                       world_from_tool(tool_vertices[corners.z]));
  bool held_by_one = false;
  uint32_t nearest = kNone;
  int64_t nearest_distance = 0l;
  const uint32_t count = min(response.areas, kMaxFrameAreas);
  for (uint32_t area = 0u; area < count; ++area) {
    const int64_t distance = area_distance(area, g);
    if (area_holds(area, g)) {
      append(area, mobile);
      held_by_one = true;
    }
    if (nearest == kNone || distance < nearest_distance ||
        (distance == nearest_distance && areas[area].id < areas[nearest].id)) {
      nearest = area;
      nearest_distance = distance;
    }
  }
  if (!held_by_one && nearest != kNone) append(nearest, mobile);
  mobile_areas[mobile] = held_by_one ? kNone : nearest;
}
