#version 460
#extension GL_GOOGLE_include_directive : require
// What the tool's fine partition says of listed samples. An invocation a SampleChunk. V_int: counts, appended to samples and marked
// kStaticSampled. V_bnd: appended to open_samples. A first corner (kCornerProbe) tells EST and does not count.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFineBrickSlot, uint32_t, fine_brick_slot);
READ(kBindFineBricks, Brick, fine_bricks);
READ(kBindSampleChunks, SampleChunk, sample_chunks);
READ(kBindMockupSamples, ivec4, mockup_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindOpenSamples, ivec4, open_samples);
EDIT(kBindSamples, ivec4, samples);
EDIT(kBindFrameLists, FrameList, frame_lists);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/static_mark.glsl"
#define PARTITION_GRID scene.fine
#define PARTITION_SLOTS fine_brick_slot
#define PARTITION_BRICKS fine_bricks
#define PARTITION(name) fine_##name
#include "shaders/lib/partition.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListSampleChunks].count) return;
  const uint32_t end = sample_chunks[item].end;
  for (uint32_t i = sample_chunks[item].begin; i < end; ++i) {
    const ivec4 work = mockup_samples[i];   // FrameSample
    const uint32_t voxel_class = fine_class_of(fine_voxel_of(tool_from_world(work.xyz)));
    if (voxel_class == kVoxelExternal) continue;
    if (voxel_class == kVoxelBoundary) {
      const uint32_t at = atomicAdd(frame_lists[kListOpenSamples].count, 1u);
      if (at < frame_lists[kListOpenSamples].capacity) open_samples[at] = work;
      continue;
    }
    mark_static(uint32_t(work.w) & ~kCornerProbe, kStaticSampled);
    if ((uint32_t(work.w) & kCornerProbe) != 0u) continue;
    const uint32_t at = atomicAdd(frame_lists[kListSamples].count, 1u);
    if (at < frame_lists[kListSamples].capacity) samples[at] = work;
  }
}
