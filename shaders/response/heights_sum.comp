#version 460
// One invocation: a run of kHeightRun samples. Adds their heights to their areas, once for each change of area in the run.
// Reads samples, heights, fades, slots, weights. Writes the sums of areas.
// Before: heights_trace (`paper`: centroids_trace).
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_response.h"

layout(constant_id = 0) const bool REFINED = true;

READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindContactStatics, uint32_t, contact_statics);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindMockupVertices, ivec3, mockup_vertices);
READ(kBindMockupTriangles, uvec3, mockup_triangles);
READ(kBindMockupWeights, uint32_t, mockup_weights);
READ(kBindHeights, uint32_t, heights);
READ(kBindFades, uint32_t, fades);
READ(kBindSlots, SlotWork, slots);
EDIT(kBindAreas, AreaWork, areas);

#include "shaders/lib/height_sum.glsl"
#include "shaders/lib/centroid.glsl"

void main() {
  const uint32_t count = frame_lists[REFINED ? kListSamples : kListContactStatics].count;
  const uint32_t begin = flat_invocation() * kHeightRun, end = min(begin + kHeightRun, count);
  uint32_t current = kNone;
  HeightSum sum = height_sum_empty();
  for (uint32_t i = begin; i < end; ++i) {
    if (heights[i] == kNone) continue;
    uint32_t slot = i, weight = 1u << 30;
    ivec3 p;
    if (REFINED) {
      const uint32_t id = frame_samples[i].static_id;
      slot = static_slot[id];
      weight = mockup_weights[id];
      p = frame_samples[i].point;
    } else {
      const uvec3 corners = mockup_triangles[contact_statics[i]];
      p = rounded_centroid(mockup_vertices[corners.x], mockup_vertices[corners.y], mockup_vertices[corners.z]);
    }
    const uint32_t area = slots[slot].area;
    if (area != current) {
      if (current != kNone) height_sum_flush(current, sum);
      current = area;
      sum = height_sum_empty();
    }
    height_sum_add(sum, p, heights[i], weight, REFINED ? fades[i] : 0u);
  }
  if (current != kNone) height_sum_flush(current, sum);
}
