#version 460
#extension GL_GOOGLE_include_directive : require
// Whether an open sample lies inside the tool: where it is closed by the winding there, else by the vote in
// its own frame. LANES invocations a sample.
// Reads the tool and its fine partition; appends samples, marks kStaticSampled. A first corner (kCornerProbe)
// tells EST and does not count.
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool CLOSED = true;   // the tool

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
TEXELS(kBindToolRecords, tool_records)
TRIPLES(kBindToolVertices, ivec3, body_vertices)
TRIPLES(kBindToolTriangles, uvec3, body_triangles)
WORDS(kBindToolInfo, uint32_t, body_info)
WORDS(kBindFineBrickSlot, uint32_t, body_brick_slot)
WORDS(kBindFineBricks, uint32_t, body_bricks)
WORDS(kBindFineListBegin, uint32_t, body_list_begin)
WORDS(kBindFineListTriangles, uint32_t, body_list)
WORDS(kBindFineShells, int32_t, body_shells)
WORDS(kBindFinePlaces, uint32_t, fine_places)
WORDS(kBindFineExit, uint32_t, fine_exit)
READ(kBindOpenSamples, ivec4, open_samples);
READ(kBindOpenPoses, uint32_t, open_poses);
EDIT(kBindStaticState, uint32_t, static_state);
EDIT(kBindStaticSlot, uint32_t, static_slot);
EDIT(kBindContactStatics, uint32_t, contact_statics);
EDIT(kBindSamples, ivec4, samples);

#define BODY_GRID scene.fine
#include "shaders/lib/static_mark.glsl"
#include "shaders/lib/sample_room.glsl"
#include "shaders/lib/tool_winding.glsl"
#include "shaders/lib/body/body_walks.glsl"

// The invocation's part of a sum that body_says_inside() reads.
int32_t inside_tool(ivec3 point) {
  if (CLOSED) return tool_winding(point);
  const ivec3 at = tool_from_world(point);
  return body_shells_at(at, body_voxel_of(at));
}

void take(ivec4 work) {
  const uint32_t entry = mark_static(uint32_t(work.w) & ~kCornerProbe, kStaticSampled);
  if ((uint32_t(work.w) & kCornerProbe) != 0u || entry == kNone) return;
  uint32_t place;
  if (take_sample(place)) samples[place] = ivec4(work.xyz, int32_t(entry));
}

void main() {
  const uint32_t item = team_item();
  const bool there = item < list_count(kListOpenSamples);
  ivec4 work;   // FrameSample
  int32_t sum = 0;
  if (there) {
    work = open_samples[item];
    if (BATCH) take_pose(open_poses[item]);
    sum = inside_tool(work.xyz);
  }
  sum = team_sum(sum);
  if (there && speaks() && body_says_inside(CLOSED, sum)) take(work);
  tell_spent();
}
