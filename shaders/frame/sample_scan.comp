#version 460
#extension GL_GOOGLE_include_directive : require
// The grid samples of listed triangles in one voxel, and what the tool's fine partition says of them. An
// invocation a SampleChunk.
// V_int: counts, appended to samples and marked kStaticSampled. V_bnd: appended to open_samples. A triangle's
// first corner is asked as well, in the voxel that holds it. Only where samples are not listed.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "shaders/lib/sample.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
TRIPLES(kBindMockupVertices, ivec3, mockup_vertices)
TRIPLES(kBindMockupTriangles, uvec3, mockup_triangles)
WORDS(kBindMockupInfo, uint32_t, mockup_info)
WORDS(kBindMockupListTriangles, uint32_t, mockup_list_triangles)
WORDS(kBindFineBrickSlot, uint32_t, tool_brick_slot)
WORDS(kBindFineBricks, uint32_t, tool_bricks)
READ(kBindSampleChunks, SampleChunk, sample_chunks);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindOpenSamples, FrameSample, open_samples);
EDIT(kBindOpenPoses, uint32_t, open_poses);
EDIT(kBindSamples, FrameSample, samples);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/sample_room.glsl"
#include "shaders/lib/broad_phase/open_room.glsl"
#define PARTITION_GRID scene.fine
#define PARTITION_SLOTS tool_brick_slot
#define PARTITION_BRICKS tool_bricks
#define PARTITION(name) tool_##name
#include "shaders/lib/partition.glsl"

void take(ivec3 point, uint32_t id) {
  const uint32_t voxel_class = tool_class_of(tool_voxel_of(tool_from_world(point)));
  if (voxel_class == kVoxelExternal) return;
  if (voxel_class == kVoxelBoundary) {
    put_open(FrameSample(point, id));
    return;
  }
  const uint32_t entry = mark_static(id, kStaticSampled);
  uint32_t at;
  if (entry != kNone && take_sample(at)) samples[at] = FrameSample(point, entry);
}

// EST by the first corner, for triangles between the samples.
void probe(ivec3 corner, uint32_t id) {
  const uint32_t voxel_class = tool_class_of(tool_voxel_of(tool_from_world(corner)));
  if (voxel_class == kVoxelInternal) mark_static(id, kStaticSampled);
  if (voxel_class == kVoxelBoundary) put_open(FrameSample(corner, id | kCornerProbe));
}

void decide(uint32_t item) {
  if (item >= list_count(kListSampleChunks)) return;
  SampleChunk work = sample_chunks[item];
  if (BATCH) {
    take_pose(uint32_t(work.voxel.z) >> 16);
    work.voxel.z &= 0xFFFF;
  }
  const int32_t spacing = scene.sample_spacing;
  const ivec3 low = scene.mockup.grid.origin + scene.mockup.grid.size * work.voxel;
  const ivec3 high = low + scene.mockup.grid.size - 1;   // the last lattice point of the half-open cube
  for (uint32_t i = work.begin; i < work.end; ++i) {
    const uint32_t id = mockup_list_triangles(i);
    const uvec3 s = mockup_triangles(id);
    SampledTriangle t;
    t.a = mockup_vertices(s.x);
    t.b = mockup_vertices(s.y);
    t.c = mockup_vertices(s.z);
    t.axis = int(mockup_info(id) >> kInfoAxisShift & 3u);
    t.normal = raw_normal(t.a, t.b, t.c);
    if (all(greaterThanEqual(t.a, low)) && all(lessThanEqual(t.a, high))) probe(t.a, id);
    // Cells that reach into the voxel and into the triangle's box; at most 64 an axis, as a voxel is at most
    // 63 spacings.
    const ivec2 first = cell_of_sample(seen_along(t.axis, max(low, min(min(t.a, t.b), t.c))), spacing);
    const ivec2 last = cell_of_sample(seen_along(t.axis, min(high, max(max(t.a, t.b), t.c))), spacing);
    for (int32_t j = first.y; j <= last.y; ++j) {
      for (int32_t i = first.x; i <= last.x; ++i) {
        const ivec2 g = sample_of_cell(ivec2(i, j), spacing);
        if (!grid_point_inside(t, g)) continue;
        const ivec3 point = sample_point(t, g);
        if (all(greaterThanEqual(point, low)) && all(lessThanEqual(point, high))) take(point, id);
      }
    }
  }
}

void main() { decide(flat_invocation()); }
