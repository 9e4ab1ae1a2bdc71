#version 460
#extension GL_GOOGLE_include_directive : require
// Boxes of clusters, and which bricks of the mock-up they meet. A workgroup a cluster, an invocation one of its triangles.
// Reads tool_world and the brick table; starts mobile_state anew, writes tool_corners and boxes, appends cluster_bricks.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/wide_integer.glsl"
#include "shaders/lib/voxel_range.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ_ONE(kBindFrameInput, FrameInput, frame_input);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolInfo, uint32_t, tool_info);
READ(kBindToolOrder, uint32_t, tool_order);
READ(kBindToolWorld, ivec3, tool_world);
EDIT(kBindMobileState, uint32_t, mobile_state);
EDIT(kBindClusterBoxes, LatticeBox, cluster_boxes);
EDIT(kBindRunBoxes, LatticeBox, run_boxes);
EDIT(kBindToolCorners, ToolCorners, tool_corners);
EDIT(kBindClusterBricks, ClusterBrick, cluster_bricks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"

// One box a run, component by component.
shared int32_t low[3 * kClusterSize / kRunSize], high[3 * kClusterSize / kRunSize];

LatticeBox run_box(uint32_t run) {
  return LatticeBox(ivec3(low[3u * run], low[3u * run + 1u], low[3u * run + 2u]), ivec3(high[3u * run], high[3u * run + 1u], high[3u * run + 2u]));
}

void main() {
  const uint32_t cluster = flat_group();
  const uint32_t lane = gl_LocalInvocationIndex;
  if (cluster * kClusterSize >= scene.tool.triangles) return;   // the whole workgroup
  if (lane < 3u * kClusterSize / kRunSize) {
    low[lane] = 0x7FFFFFFF;
    high[lane] = -0x7FFFFFFF;
  }
  barrier();

  // Each triangle begins the pose without a set; void ones stay out of boxes and of everything.
  const uint32_t place = cluster * kClusterSize + lane;
  if (place < scene.tool.triangles) {
    const uint32_t mobile = tool_order[place];
    const uvec3 t = tool_triangles[mobile];
    const ivec3 a = tool_world[t.x], b = tool_world[t.y], c = tool_world[t.z];
    const bool is_void = (tool_info[mobile] & kInfoCollapsed) != 0u || raw_normal(a, b, c) == i64vec3(0);
    mobile_state[mobile] = is_void ? kMobileVoid : 0u;
    if (is_void) {
      tool_corners[place] = ToolCorners(a, a, a);
    } else {
      tool_corners[place] = ToolCorners(a, b, c);
      const ivec3 l = min(min(a, b), c), h = max(max(a, b), c);
      const uint32_t run = lane / kRunSize;
      for (uint32_t k = 0u; k < 3u; ++k) {
        atomicMin(low[3u * run + k], l[k]);
        atomicMax(high[3u * run + k], h[k]);
      }
    }
  }
  barrier();
  const uint32_t runs = kClusterSize / kRunSize;
  LatticeBox box = run_box(0u);
  for (uint32_t run = 1u; run < runs; ++run) {
    box.low = min(box.low, run_box(run).low);
    box.high = max(box.high, run_box(run).high);
  }
  if (lane < runs && place - lane + lane * kRunSize < scene.tool.triangles) run_boxes[cluster * runs + lane] = run_box(lane);
  if (lane == 0u) cluster_boxes[cluster] = box;
  if (box.low.x > box.high.x) return;   // all are void

  // Bricks that its box touches.
  const int32_t side = scene.mockup.grid.size * 8;
  const ivec3 first = max(first_touched(box.low, scene.mockup.grid.origin, side), frame_input.brick_first);
  const ivec3 last = min(last_touched(box.high, scene.mockup.grid.origin, side), frame_input.brick_last);
  if (any(greaterThan(first, last))) return;
  const uvec3 n = uvec3(last - first + 1);
  uint32_t count = n.x * n.y * n.z;
  if (count > kLoopBudget * kGroupSize) {
    if (lane == 0u) atomicOr(frame_state.overflow_other, kOverflowLoop);
    count = 0u;
  }
  for (uint32_t i = lane; i < count; i += kGroupSize) {
    const uvec3 brick = uvec3(first) + uvec3(i % n.x, i / n.x % n.y, i / (n.x * n.y));
    const uint32_t number = brick.x + uint32_t(scene.mockup.grid.bricks.x) * (brick.y + uint32_t(scene.mockup.grid.bricks.y) * brick.z);
    if (mockup_brick_slot[number] == kBrickExternal) continue;
    const uint32_t at = take_room(kListClusterBricks, 1u);
    if (at < frame_lists[kListClusterBricks].capacity) cluster_bricks[at] = ClusterBrick(cluster, number);
  }
}
