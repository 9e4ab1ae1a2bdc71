#version 460
#extension GL_GOOGLE_include_directive : require
// What the tool's fine partition says of listed samples. An invocation a SampleChunk. Each goes through its
// points in rounds; those not in V_ext are shared out. V_int: counts, appended to samples and marked
// kStaticSampled; a first corner (kCornerProbe) tells EST and does not count. V_bnd: appended to
// open_samples.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"

layout(constant_id = 0) const bool WIDE = false;   // voxels of more than kNarrowVoxel steps

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
WORDS(kBindFineBrickSlot, uint32_t, fine_brick_slot)
WORDS(kBindFineBricks, uint32_t, fine_bricks)
READ(kBindSamplePoints, uint32_t, sample_points);
WORDS(kBindSampleIds, uint32_t, sample_ids)
READ(kBindSampleChunks, SampleChunk, sample_chunks);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindOpenSamples, FrameSample, open_samples);
EDIT(kBindOpenPoses, uint32_t, open_poses);
EDIT(kBindSamples, FrameSample, samples);

#include "shaders/lib/batch/group_poses.glsl"
#include "shaders/lib/pose.glsl"
#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/sample_room.glsl"
#include "shaders/lib/broad_phase/open_room.glsl"
#define PARTITION_GRID scene.fine
#define PARTITION_SLOTS fine_brick_slot
#define PARTITION_BRICKS fine_bricks
#define PARTITION(name) fine_##name
#include "shaders/lib/partition.glsl"

const uint32_t kRoom = LISTED_CHUNK * kGroupSize;
const uint32_t kPointCost = 2u;   // with what putting it by takes: what has been reserved is filled
shared uint64_t found[kRoom];   // a round's points that are not in V_ext: point + 2^32 · invocation
shared int32_t lows[3u * kGroupSize];   // of the invocations' voxels
shared uint32_t inside_count, open_count, unfinished;

ivec3 point_at(uint32_t i) {
  if (WIDE) return ivec3(sample_points[3u * i], sample_points[3u * i + 1u], sample_points[3u * i + 2u]);
  const uint32_t a = sample_points[2u * i], b = sample_points[2u * i + 1u];
  return ivec3(a & 0xFFFFFu, a >> 20 | (b & 0xFFu) << 12, b >> 8);
}

uint32_t point = 0u, end = 0u;   // of the invocation's chunk
ivec3 low;                       // its voxel's low corner

void begin(uint32_t lane, uint32_t item) {
  no_pose(lane);
  if (item >= list_count(kListSampleChunks)) return;
  SampleChunk work = sample_chunks[item];
  if (BATCH) {
    take_pose(uint32_t(work.voxel.z) >> 16);
    work.voxel.z &= 0xFFFF;
  }
  put_pose(lane);
  low = scene.mockup.grid.origin + scene.mockup.grid.size * work.voxel;
  for (uint32_t k = 0u; k < 3u; ++k) lows[3u * lane + k] = low[k];
  point = work.begin;
  end = work.end;
}

// Goes on with it for whoever has found it.
FrameSample sample_of(uint64_t work) {
  const uint32_t i = uint32_t(work), of = 3u * uint32_t(work >> 32);
  go_on_for(uint32_t(work >> 32));
  return FrameSample(ivec3(lows[of], lows[of + 1u], lows[of + 2u]) + point_at(i), sample_ids(i));
}

void take(FrameSample sample_) {
  const uint32_t entry = mark_static(sample_.static_id & ~kCornerProbe, kStaticSampled);
  if ((sample_.static_id & kCornerProbe) != 0u || entry == kNone) return;
  uint32_t place;
  if (take_sample(place)) samples[place] = FrameSample(sample_.point, entry);
}

void main() {
  const uint32_t lane = gl_LocalInvocationIndex;
  begin(lane, flat_invocation());
  bool again = true;
  while (again) {
    if (lane == 0u) inside_count = open_count = unfinished = 0u;
    barrier();
    const uint32_t first = point, last = min(point + LISTED_CHUNK, end);
    uint32_t in_solid = 0u, near_surface = 0u;   // bits: which of them are
    for (; point < last && !spent(kPointCost); ++point) {
      const uint32_t voxel_class = fine_class_of(fine_voxel_of(tool_from_world(low + point_at(point))));
      in_solid |= uint32_t(voxel_class == kVoxelInternal) << (point - first);
      near_surface |= uint32_t(voxel_class == kVoxelBoundary) << (point - first);
    }
    // Those of V_int from the front on, the others from the back.
    if (in_solid != 0u) {
      uint32_t at = atomicAdd(inside_count, uint32_t(bitCount(in_solid)));
      for (; in_solid != 0u; in_solid &= in_solid - 1u)
        found[at++] = uint64_t(first + uint32_t(findLSB(in_solid))) | uint64_t(lane) << 32;
    }
    if (near_surface != 0u) {
      uint32_t at = kRoom - atomicAdd(open_count, uint32_t(bitCount(near_surface)));
      for (; near_surface != 0u; near_surface &= near_surface - 1u)
        found[--at] = uint64_t(first + uint32_t(findLSB(near_surface))) | uint64_t(lane) << 32;
    }
    if (point < end && loop_budget < kLoopBudget) unfinished = 1u;
    barrier();
    const uint32_t inside = inside_count, open = open_count;
    again = unfinished != 0u;
    for (uint32_t i = lane; i < inside && !spent(1u); i += kGroupSize) take(sample_of(found[i]));
    for (uint32_t i = lane; i < open && !spent(1u); i += kGroupSize)
      put_open(sample_of(found[kRoom - 1u - i]));
    barrier();
  }
  tell_left_undone(lane);
}
