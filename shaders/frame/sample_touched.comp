#version 460
#extension GL_GOOGLE_include_directive : require
// For a tool without inside: the samples in touched V_bnd voxels count. An invocation a touched voxel; appends sample_chunks.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindTouchedVoxels, FrameVoxel, touched_voxels);
EDIT(kBindSampleChunks, SampleChunk, sample_chunks);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/sample_chunks.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListTouchedVoxels].count) return;
  ask_for_samples(touched_voxels[item].voxel, touched_voxels[item].boundary);
}
