#version 460
#extension GL_GOOGLE_include_directive : require
// Whether an open sample lies inside a closed tool: the winding there is what a walk out of the tool crosses, along an axis of its
// fine grid, from voxel to voxel, and each voxel lists all that may be crossed in it. An invocation a sample.
// Reads the tool and its fine partition; appends samples, marks kStaticSampled.
//
// The walk's points on the faces between voxels are lattice points of the tool, moved to the world and rounded. That, the rounding
// of the sample and that of the triangles' corners come to less than two steps, and voxels are grown by kToolVoxelGrowth; so a voxel's
// list holds all that the walk crosses in it, and at the face of a V_ext voxel the winding is 0.
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "shaders/lib/segment.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindFineBrickSlot, uint32_t, fine_brick_slot);
READ(kBindFineBricks, Brick, fine_bricks);
READ(kBindFineListBegin, uint32_t, fine_list_begin);
READ(kBindFinePlaces, uint32_t, fine_places);
READ(kBindFineExit, uint32_t, fine_exit);
READ(kBindOpenSamples, ivec4, open_samples);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, ivec4, samples);
EDIT(kBindFrameLists, FrameList, frame_lists);
EDIT_ONE(kBindFrameState, FrameState, frame_state);

#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/budget.glsl"
#define PARTITION_GRID scene.fine
#define PARTITION_SLOTS fine_brick_slot
#define PARTITION_BRICKS fine_bricks
#define PARTITION(name) fine_##name
#include "shaders/lib/partition.glsl"

void main() {
  const uint32_t item = flat_invocation();
  if (item >= frame_lists[kListOpenSamples].count) return;
  const ivec4 work = open_samples[item];   // FrameSample
  ivec3 from = work.xyz, at = tool_from_world(from);
  ivec3 voxel = fine_voxel_of(at);
  uint32_t boundary = fine_boundary_index(voxel);
  const uint32_t exit = fine_exit[boundary];
  const int axis = int(exit >> 1);
  const int32_t step = int32_t(exit & 1u) * 2 - 1;
  int32_t winding = 0;
  while (!spent(1u)) {
    at[axis] = scene.fine.origin[axis] + scene.fine.size * (voxel[axis] + int32_t(exit & 1u));
    const ivec3 to = world_from_tool(at);
    if (boundary != kNoVoxel && from != to) {
      const uint32_t end = fine_list_begin[boundary + 1u];
      for (uint32_t i = fine_list_begin[boundary]; i < end && !spent(1u); ++i) {
        const RecordCorners t = record_at(fine_places[i]);
        winding += segment_crossing(from, to, world_from_tool(t.a), world_from_tool(t.b), world_from_tool(t.c));
      }
    }
    from = to;
    voxel[axis] += step;
    boundary = fine_boundary_index(voxel);
    if (boundary == kNoVoxel && fine_class_of(voxel) == kVoxelExternal) break;
  }
  if (winding == 0) return;
  mark_static(uint32_t(work.w) & ~kCornerProbe, kStaticSampled);
  if ((uint32_t(work.w) & kCornerProbe) != 0u) return;
  const uint32_t place = atomicAdd(frame_lists[kListSamples].count, 1u);
  if (place < frame_lists[kListSamples].capacity) samples[place] = work;
}
