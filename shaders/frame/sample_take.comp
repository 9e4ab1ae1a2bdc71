#version 460
#extension GL_GOOGLE_include_directive : require
// Samples that the tool's fine partition has inside (found by the host, compute/search/near_samples.h). An
// invocation a sample; appends samples and marks kStaticSampled. A first corner (kCornerProbe) tells EST and
// does not count.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindInsideSamples, u64vec2, inside_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, u64vec2, samples);

#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/sample_room.glsl"

void decide(uint32_t item) {
  if (item >= frame_input.inside_samples) return;
  const u64vec2 work = inside_samples[item];   // FrameSample
  const uint32_t id = uint32_t(work.y >> 32);
  mark_static(id & ~kCornerProbe, kStaticSampled);
  if ((id & kCornerProbe) != 0u) return;
  uint32_t at;
  if (take_sample(at)) samples[at] = work;
}

void main() { decide(flat_invocation()); }
