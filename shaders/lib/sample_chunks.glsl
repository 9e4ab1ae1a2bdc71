// Asks for the samples in a V_bnd voxel. The including file has scene, mockup_list_begin, sample_chunks, and
// lib/list_room.glsl.
#ifndef PALPATE_SAMPLE_CHUNKS_GLSL
#define PALPATE_SAMPLE_CHUNKS_GLSL
void ask_for_samples(ivec3 voxel, uint32_t boundary) {
  const uint32_t begin = mockup_list_begin[boundary], end = mockup_list_begin[boundary + 1u];
  const uint32_t chunk = chunk_of(end - begin, kSampleChunk, kMostChunks);
  const uint32_t along = uint32_t(scene.mockup.grid.size / scene.sample_spacing) + 1u;   // grid points of a voxel along an axis
  if (chunk * along * (along + 1u) > kLoopBudget) {   // the invocation of a chunk could run beyond the budget
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t chunks = (end - begin + chunk - 1u) / chunk;
  const uint32_t first = take_room(kListSampleChunks, chunks);
  for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListSampleChunks].capacity; ++i)
    sample_chunks[first + i] = SampleChunk(voxel, begin + i * chunk, min(begin + (i + 1u) * chunk, end));
}
#endif
