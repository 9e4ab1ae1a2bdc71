#version 460
#extension GL_GOOGLE_include_directive : require
// Whether an open sample lies inside the tool: the winding of the transformed tool round it, along +x. A workgroup a sample;
// invocations share out clusters, then the triangles of the clusters that the ray may meet.
// Reads tool_world, cluster_boxes, mobile_state; appends samples, marks kStaticSampled.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/ray.glsl"

READ_ONE(kBindScene, SceneConstants, scene);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolOrder, uint32_t, tool_order);
READ(kBindToolWorld, ivec3, tool_world);
READ(kBindClusterBoxes, LatticeBox, cluster_boxes);
READ(kBindMobileState, uint32_t, mobile_state);
READ(kBindOpenSamples, FrameSample, open_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, FrameSample, samples);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/static_mark.glsl"

shared uint32_t near[kGroupSize];
shared uint32_t near_count;
shared int32_t winding;

bool ray_may_meet(ivec3 p, LatticeBox box) {
  return box.low.y <= p.y && p.y <= box.high.y && box.low.z <= p.z && p.z <= box.high.z && box.high.x >= p.x;
}

void main() {
  const uint32_t item = flat_group();
  const uint32_t lane = gl_LocalInvocationIndex;
  if (item >= frame_lists[kListOpenSamples].count) return;   // the whole workgroup
  const FrameSample work = open_samples[item];
  const uint32_t clusters = (scene.tool.triangles + kClusterSize - 1u) / kClusterSize;
  int32_t mine = 0;
  uint32_t steps = 0u;
  if (lane == 0u) winding = 0;

  for (uint32_t base = 0u; base < clusters && steps < kLoopBudget; base += kGroupSize) {
    if (lane == 0u) near_count = 0u;
    barrier();
    if (base + lane < clusters && ray_may_meet(work.point, cluster_boxes[base + lane]))
      near[atomicAdd(near_count, 1u)] = base + lane;
    barrier();
    const uint32_t found = near_count;
    for (uint32_t i = 0u; i < found; ++i) {
      const uint32_t place = near[i] * kClusterSize + lane;
      if (place >= scene.tool.triangles) continue;
      const uint32_t mobile = tool_order[place];
      const uvec3 t = tool_triangles[mobile];
      mine += x_crossing(work.point, tool_world[t.x], tool_world[t.y], tool_world[t.z]);
    }
    steps += found + 1u;
    barrier();   // the list is read before it is emptied
  }
  if (steps >= kLoopBudget && lane == 0u) atomicOr(frame_state.overflow_other, kOverflowLoop);
  atomicAdd(winding, mine);
  barrier();
  if (lane != 0u || winding == 0) return;
  mark_static(work.static_id, kStaticSampled);
  const uint32_t at = atomicAdd(frame_lists[kListSamples].count, 1u);
  if (at < frame_lists[kListSamples].capacity) samples[at] = work;
}
