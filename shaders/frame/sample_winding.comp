#version 460
#extension GL_GOOGLE_include_directive : require
// Whether an open sample lies inside the tool: the winding of the transformed tool round it, along +x. An invocation a sample; it
// goes through the triangles of its bin and through the wide ones. Reads tool_corners and the bins; appends samples, marks
// kStaticSampled.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/ray.glsl"

CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindToolCorners, ToolCorners, tool_corners);
READ(kBindToolBins, ToolBin, tool_bins);
READ(kBindBinEntries, uint32_t, bin_entries);
READ(kBindWideTriangles, uint32_t, wide_triangles);
READ_ONE(kBindBinState, BinState, bin_state);
READ(kBindOpenSamples, FrameSample, open_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, FrameSample, samples);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/tool_bins.glsl"

// Sign of the crossing, after a look at the box: a perturbed ray that crosses a triangle touches its closed box.
int crossing_of(ivec3 p, uint32_t place) {
  const ToolCorners t = tool_corners[place];
  const ivec3 low = min(min(t.a, t.b), t.c), high = max(max(t.a, t.b), t.c);
  if (p.y < low.y || p.y > high.y || p.z < low.z || p.z > high.z || p.x > high.x) return 0;
  return x_crossing(p, t.a, t.b, t.c);
}

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListOpenSamples].count) return;
  const FrameSample work = open_samples[item];
  if (any(lessThan(work.point, frame_input.tool_low)) || any(greaterThan(work.point, frame_input.tool_high))) return;
  const ToolBin bin = tool_bins[bin_number(bin_place(work.point))];
  if (bin.count + bin_state.wide > kLoopBudget) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  int32_t winding = 0;
  for (uint32_t i = 0u; i < bin.count; ++i) winding += crossing_of(work.point, bin_entries[bin.begin + i]);
  for (uint32_t i = 0u; i < bin_state.wide; ++i) winding += crossing_of(work.point, wide_triangles[i]);
  if (winding == 0) return;
  mark_static(work.static_id & ~kCornerProbe, kStaticSampled);
  if ((work.static_id & kCornerProbe) != 0u) return;
  const uint32_t at = atomicAdd(frame_lists[kListSamples].count, 1u);
  if (at < frame_lists[kListSamples].capacity) samples[at] = work;
}
