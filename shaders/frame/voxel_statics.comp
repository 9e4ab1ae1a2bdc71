#version 460
#extension GL_GOOGLE_include_directive : require
// The static triangles listed in touched V_bnd voxels (BST unless CST). An invocation a VoxelChunk; marks kStaticListed.
#include "shaders/lib/frame.glsl"

READ(kBindMockupListTriangles, uint32_t, mockup_list_triangles);
READ(kBindVoxelChunks, VoxelChunk, voxel_chunks);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindFrameLists, FrameList, frame_lists);

#include "shaders/lib/static_mark.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListVoxelChunks].count) return;
  const VoxelChunk work = voxel_chunks[item];
  for (uint32_t i = work.begin; i < work.end; ++i) mark_static(mockup_list_triangles[i], kStaticListed);
}
