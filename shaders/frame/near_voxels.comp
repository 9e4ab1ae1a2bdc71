#version 460
#extension GL_GOOGLE_include_directive : require
// Moves what is near to the pose, and finds the V_bnd and V_int voxels of a brick that a triangle may touch or come close to. An
// invocation a NearTriangle. Reads tool_records and the partition; writes mobile_corners, appends touch_candidates; a
// brick that is all V_int settles kMobileInternal here.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/triangle_voxel.glsl"
#include "shaders/lib/voxel_range.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindNearTriangles, uvec4, near_triangles);
READ(kBindToolRecords, uvec4, tool_records);
READ(kBindMockupBricks, Brick, mockup_bricks);
EDIT(kBindMobileCorners, ToolCorners, mobile_corners);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindContactMobiles, uint32_t, contact_mobiles);
EDIT(kBindTouchCandidates, uvec4, touch_candidates);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/mobile_mark.glsl"

const int32_t kFewVoxels = 64;   // beyond, a look at the brick as a whole comes first (chosen)

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_input.near_triangles) return;
  const uvec4 work = near_triangles[item];   // NearTriangle
  const uint32_t place = work.x & ~kFirstOfTriangle;
  const uvec4 a_id = tool_records[3u * place], b_info = tool_records[3u * place + 1u], c_none = tool_records[3u * place + 2u];
  if ((b_info.w & kInfoCollapsed) != 0u) return;
  const uint32_t mobile = a_id.w, slot = work.y;
  const ivec3 a = world_from_tool(ivec3(a_id.xyz)), b = world_from_tool(ivec3(b_info.xyz)), c = world_from_tool(ivec3(c_none.xyz));
  if ((work.x & kFirstOfTriangle) != 0u) mobile_corners[mobile] = ToolCorners(a, b, c);
  const i64vec3 normal = raw_normal(a, b, c);
  if (normal == i64vec3(0l)) return;   // collinear at this pose

  const int32_t size = scene.mockup.grid.size;
  const ivec3 brick = ivec3(work.z & 0xFFFFu, work.z >> 16, work.w);
  const ivec3 origin = scene.mockup.grid.origin + 8 * size * brick;
  if (slot == kBrickInternal) {
    if (triangle_touches_box(a, b, c, normal, origin, origin + 8 * size)) mark_mobile(mobile, kMobileInternal);
    return;
  }
  const ivec3 low = min(min(a, b), c) - kCloseSteps - origin, high = max(max(a, b), c) + kCloseSteps - origin;
  if (any(greaterThan(low, ivec3(8 * size))) || any(lessThan(high, ivec3(0)))) return;
  const ivec3 first = max(cell_along(low - 1, size, 8), ivec3(0)), last = min(cell_along(high, size, 8), ivec3(7));
  const ivec3 n = last - first + 1;
  if (n.x * n.y * n.z > kFewVoxels && !triangle_touches_box(a, b, c, normal, origin - kCloseSteps, origin + 8 * size + kCloseSteps)) return;
  const uint32_t along_x = (2u << last.x) - (1u << first.x);
  for (int32_t z = first.z; z <= last.z; ++z) {
    for (int32_t y = first.y; y <= last.y; ++y) {
      const uint32_t word = uint32_t(y >> 2 | z << 1), shift = uint32_t(y & 3) * 8u;
      const uint32_t boundary = mockup_bricks[slot].boundary[word];
      for (uint32_t row = (boundary | mockup_bricks[slot].internal_[word]) >> shift & along_x; row != 0u; row &= row - 1u) {
        const uint32_t x = uint32_t(findLSB(row)), bit = 1u << (x + shift);
        const uint32_t number = (boundary & bit) == 0u ? kNoVoxel : mockup_bricks[slot].first[word] + uint32_t(bitCount(boundary & (bit - 1u)));
        const ivec3 voxel = 8 * brick + ivec3(x, y, z);
        const uint32_t at = take_room(kListTouchCandidates, 1u);
        if (at < frame_lists[kListTouchCandidates].capacity) touch_candidates[at] = uvec4(mobile, number, voxel.x | voxel.y << 16, voxel.z);
      }
    }
  }
}
