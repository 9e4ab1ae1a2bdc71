#version 460
#extension GL_GOOGLE_include_directive : require
// The whole tool at its pose, for rays: corners, and boxes of clusters and runs. A workgroup a cluster, an
// invocation one of its triangles. Reads tool_records; writes tool_corners and boxes.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/wide_integer.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindToolRecords, uvec4, tool_records);
EDIT(kBindClusterBoxes, LatticeBox, cluster_boxes);
EDIT(kBindRunBoxes, LatticeBox, run_boxes);
EDIT(kBindToolCorners, ToolCorners, tool_corners);

#include "shaders/lib/pose.glsl"

// One box a run, component by component.
shared int32_t low[3 * kClusterSize / kRunSize], high[3 * kClusterSize / kRunSize];

LatticeBox run_box(uint32_t run) {
  return LatticeBox(ivec3(low[3u * run], low[3u * run + 1u], low[3u * run + 2u]),
                    ivec3(high[3u * run], high[3u * run + 1u], high[3u * run + 2u]));
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

  // Void triangles stay out of boxes.
  const uint32_t place = cluster * kClusterSize + lane;
  if (place < scene.tool.triangles) {
    const uvec4 a_id = tool_records[3u * place], b_info = tool_records[3u * place + 1u],
                c_none = tool_records[3u * place + 2u];
    const ivec3 a = world_from_tool(ivec3(a_id.xyz)), b = world_from_tool(ivec3(b_info.xyz)),
                c = world_from_tool(ivec3(c_none.xyz));
    if ((b_info.w & kInfoCollapsed) != 0u || raw_normal(a, b, c) == i64vec3(0l)) {
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
  if (lane < runs && cluster * kClusterSize + lane * kRunSize < scene.tool.triangles)
    run_boxes[cluster * runs + lane] = run_box(lane);
  if (lane != 0u) return;
  LatticeBox box = run_box(0u);
  for (uint32_t run = 1u; run < runs; ++run) {
    box.low = min(box.low, run_box(run).low);
    box.high = max(box.high, run_box(run).high);
  }
  cluster_boxes[cluster] = box;
}
