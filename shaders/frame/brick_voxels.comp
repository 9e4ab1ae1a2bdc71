#version 460
#extension GL_GOOGLE_include_directive : require
// The V_bnd and V_int voxels of a mixed brick that lie in a triangle's box. An invocation a TriangleBrick.
// Reads tool_world and the partition; appends touch_candidates.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindTriangleBricks, TriangleBrick, triangle_bricks);
EDIT(kBindTouchCandidates, TouchCandidate, touch_candidates);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListTriangleBricks].count) return;
  const TriangleBrick work = triangle_bricks[item];
  const uint32_t slot = mockup_brick_slot[work.brick];
  if (slot >= kBrickInternal) return;   // all V_int: settled already

  const uvec3 t = tool_triangles[work.mobile];
  const ivec3 a = tool_world[t.x], b = tool_world[t.y], c = tool_world[t.z];
  const int32_t size = scene.mockup.grid.size;
  const ivec3 origin = scene.mockup.grid.origin + 8 * size * brick_at(work.brick, scene.mockup.grid.bricks);
  const ivec3 first = max(first_touched(min(min(a, b), c), origin, size), ivec3(0));
  const ivec3 last = min(last_touched(max(max(a, b), c), origin, size), ivec3(7));
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        const uint32_t bit = uint32_t(x | y << 3 | z << 6);
        const uint32_t used = mockup_bricks[slot].boundary[bit >> 5] | mockup_bricks[slot].internal_[bit >> 5];
        if ((used >> (bit & 31u) & 1u) == 0u) continue;
        const uint32_t at = take_room(kListTouchCandidates, 1u);
        if (at < frame_lists[kListTouchCandidates].capacity)
          touch_candidates[at] = TouchCandidate(work.mobile, work.brick, bit);
      }
    }
  }
}
