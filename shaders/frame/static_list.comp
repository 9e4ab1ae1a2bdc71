#version 460
#extension GL_GOOGLE_include_directive : require
// Marks what touched V_bnd voxels list: BST, unless CST. An invocation a StaticChunk. Reads the voxels'
// lists; marks kStaticListed.
#include "shaders/lib/frame.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);
READ(kBindMockupListTriangles, uint32_t, mockup_list_triangles);
READ(kBindStaticChunks, uvec2, static_chunks);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);

#include "shaders/lib/static_mark.glsl"

void decide(uint32_t item) {
  if (item >= list_count(kListStaticChunks)) return;
  const uvec2 work = static_chunks[item];   // StaticChunk
  for (uint32_t i = work.x; i < work.y; ++i) mark_static(mockup_list_triangles[i], kStaticListed);
}

void main() { decide(flat_invocation()); }
