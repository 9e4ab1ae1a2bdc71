#version 460
#extension GL_GOOGLE_include_directive : require
// Enters tool triangles in the bins that their boxes meet. An invocation a place in the order of clusters; twice: COUNT = 1 counts,
// 0 enters (after bins_place). Reads tool_corners; writes tool_bins and bin_entries; wide ones go to wide_triangles.
#include "shaders/lib/frame.glsl"

layout(constant_id = 0) const uint32_t COUNT = 0u;

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindToolCorners, ToolCorners, tool_corners);
EDIT(kBindToolBins, ToolBin, tool_bins);
EDIT(kBindBinEntries, uint32_t, bin_entries);
EDIT(kBindWideTriangles, uint32_t, wide_triangles);
EDIT_ONE(kBindBinState, BinState, bin_state);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/tool_bins.glsl"

void main() {
  const uint32_t place = flat_invocation();
  if (place >= scene.tool.triangles) return;
  const ToolCorners t = tool_corners[place];
  if (t.a == t.b && t.b == t.c) return;   // void
  const uvec2 first = bin_place(min(min(t.a, t.b), t.c)), last = bin_place(max(max(t.a, t.b), t.c));
  const uvec2 n = last - first + 1u;
  if (n.x * n.y > kWideTriangle) {
    if (COUNT != 0u) wide_triangles[atomicAdd(bin_state.wide, 1u)] = place;   // there is room for all triangles
    return;
  }
  for (uint32_t y = first.x; y <= last.x; ++y) {
    for (uint32_t z = first.y; z <= last.y; ++z) {
      const uint32_t bin = bin_number(uvec2(y, z));
      if (COUNT != 0u) {
        atomicAdd(tool_bins[bin].count, 1u);
        continue;
      }
      const uint32_t at = tool_bins[bin].begin + atomicAdd(tool_bins[bin].filled, 1u);
      if (at < uint32_t(bin_entries.length())) bin_entries[at] = place;
      else atomicOr(frame_state.overflow_other, kOverflowBins);
    }
  }
}
