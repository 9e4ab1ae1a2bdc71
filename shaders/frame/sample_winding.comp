#version 460
#extension GL_GOOGLE_include_directive : require
// Whether an open sample lies inside the tool: the winding of the transformed tool round it, along +x. An invocation a sample;
// neighbours in the list are neighbours in space, so that a group goes through much the same triangles.
// Reads tool_corners and the boxes of clusters and runs; appends samples, marks kStaticSampled.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/ray.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindToolCorners, ToolCorners, tool_corners);
READ(kBindClusterBoxes, LatticeBox, cluster_boxes);
READ(kBindRunBoxes, LatticeBox, run_boxes);
READ(kBindOpenSamples, FrameSample, open_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, FrameSample, samples);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/static_mark.glsl"

// A perturbed ray that crosses a triangle touches its closed box.
bool ray_may_meet(ivec3 p, ivec3 low, ivec3 high) {
  return low.y <= p.y && p.y <= high.y && low.z <= p.z && p.z <= high.z && high.x >= p.x;
}

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListOpenSamples].count) return;
  const FrameSample work = open_samples[item];
  const uint32_t clusters = (scene.tool.triangles + kClusterSize - 1u) / kClusterSize;
  int32_t winding = 0;
  uint32_t steps = 0u;
  for (uint32_t cluster = 0u; cluster < clusters && steps < kLoopBudget; ++cluster) {
    ++steps;
    if (!ray_may_meet(work.point, cluster_boxes[cluster].low, cluster_boxes[cluster].high)) continue;
    const uint32_t end = min((cluster + 1u) * kClusterSize, scene.tool.triangles);
    for (uint32_t first = cluster * kClusterSize; first < end; first += kRunSize) {
      ++steps;
      const LatticeBox run = run_boxes[first / kRunSize];
      if (!ray_may_meet(work.point, run.low, run.high)) continue;
      steps += kRunSize;
      for (uint32_t place = first; place < min(first + kRunSize, end); ++place) {
        const ToolCorners t = tool_corners[place];
        if (ray_may_meet(work.point, min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c))) winding += x_crossing(work.point, t.a, t.b, t.c);
      }
    }
  }
  if (steps >= kLoopBudget) atomicOr(frame_state.overflow_other, kOverflowLoop);
  if (winding == 0) return;
  mark_static(work.static_id, kStaticSampled);
  const uint32_t at = atomicAdd(frame_lists[kListSamples].count, 1u);
  if (at < frame_lists[kListSamples].capacity) samples[at] = work;
}
