// Asks for the samples in a V_bnd voxel. The including file has mockup_list_begin, sample_chunks, frame_lists, frame_state.
#ifndef PALPATE_SAMPLE_CHUNKS_GLSL
#define PALPATE_SAMPLE_CHUNKS_GLSL
void ask_for_samples(ivec3 voxel, uint32_t boundary) {
  const uint32_t begin = mockup_list_begin[boundary], end = mockup_list_begin[boundary + 1u];
  const uint32_t chunks = (end - begin + kSampleChunk - 1u) / kSampleChunk;
  if (chunks > kLoopBudget / 16u) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  const uint32_t first = atomicAdd(frame_lists[kListSampleChunks].count, chunks);
  for (uint32_t i = 0u; i < chunks && first + i < frame_lists[kListSampleChunks].capacity; ++i)
    sample_chunks[first + i] = SampleChunk(voxel, begin + i * kSampleChunk, min(begin + (i + 1u) * kSampleChunk, end));
}
#endif
