#version 460
#extension GL_GOOGLE_include_directive : require
// Mixed bricks that the tool's partition may reach. An invocation a brick of FrameInput's range; appends sample_bricks.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
EDIT(kBindSampleBricks, uint32_t, sample_bricks);
EDIT(kBindFrameLists, FrameList, frame_lists);

#include "shaders/lib/pose.glsl"

void main() {
  const uvec3 n = uvec3(frame_input.brick_last - frame_input.brick_first + 1);
  const uint32_t i = flat_invocation();
  if (i >= n.x * n.y * n.z) return;
  const ivec3 brick = frame_input.brick_first + ivec3(i % n.x, i / n.x % n.y, i / (n.x * n.y));
  const uvec3 b = uvec3(brick), all_bricks = uvec3(scene.mockup.grid.bricks);
  const uint32_t number = b.x + all_bricks.x * (b.y + all_bricks.y * b.z);
  if (mockup_brick_slot[number] >= kBrickInternal) return;

  // The brick in the tool's frame: a box round it against the tool's grid.
  const int32_t half_side = 4 * scene.mockup.grid.size;
  const ivec3 centre = tool_from_world(scene.mockup.grid.origin + 2 * half_side * brick + half_side);
  const ivec3 reach = tool_reach(half_side);
  const ivec3 low = scene.tool.grid.origin, high = low + 8 * scene.tool.grid.size * scene.tool.grid.bricks;
  if (any(lessThan(centre + reach, low)) || any(greaterThanEqual(centre - reach, high))) return;
  const uint32_t at = atomicAdd(frame_lists[kListSampleBricks].count, 1u);
  if (at < frame_lists[kListSampleBricks].capacity) sample_bricks[at] = number;
}
