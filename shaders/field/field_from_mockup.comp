#version 460
// LANES invocations: a sample of the mock-up that counts; behind the last one's workgroup an extra one, which is
// asked first whether it lies inside the tool. Adds how the tool's depth there pushes.
// Reads samples or mockup_points, both bodies, the tool's fine partition. Writes field_work, carrier_work,
// ignored patches.
// Before: field_members; the lists are closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/shared/frame_field.h"

layout(constant_id = 0) const bool CLOSED = true;   // the tool

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindSamples, FrameSample, frame_samples);
READ(kBindMockupPoints, FieldPoint, mockup_points);
READ(kBindMockupInfo, uint32_t, mockup_info);
READ(kBindMockupNormals, ivec3, mockup_normals);
READ(kBindMockupWeights, uint32_t, mockup_weights);
READ(kBindMockupPatches, uint32_t, mockup_patches);
READ(kBindMockupLevels, uint32_t, mockup_levels);
READ(kBindStaticState, uint32_t, static_state);
READ(kBindStaticSlot, uint32_t, static_slot);
READ(kBindToolRecords, uint64_t, tool_records);
READ(kBindToolVertices, ivec3, body_vertices);
READ(kBindToolTriangles, uvec3, body_triangles);
READ(kBindToolInfo, uint32_t, body_info);
READ(kBindToolNormals, ivec3, body_normals);
READ(kBindFineBrickSlot, uint32_t, body_brick_slot);
READ(kBindFineBricks, Brick, body_bricks);
READ(kBindFineListBegin, uint32_t, body_list_begin);
READ(kBindFineListTriangles, uint32_t, body_list);
READ(kBindFineShells, int32_t, body_shells);
READ(kBindFinePlaces, uint32_t, fine_places);
READ(kBindFineExit, uint32_t, fine_exit);
EDIT(kBindFieldWork, int64_t, field_work);
EDIT(kBindCarrierWork, int64_t, carrier_work);
READ(kBindIgnored, uint32_t, ignored);
EDIT(kBindIgnoredState, uint32_t, ignored_state);
EDIT(kBindResultIgnored, uint32_t, result_ignored);

#define BODY_GRID scene.fine
#include "shaders/lib/list_room.glsl"
#include "shaders/lib/group_count.glsl"
#include "shaders/lib/batch/posed_table.glsl"
POSED_TABLE(static, kBindStaticKeys)
#include "shaders/lib/body/body_depth.glsl"
#include "shaders/lib/body/body_walks.glsl"
#include "shaders/lib/field_sums.glsl"
#include "shaders/lib/ignored.glsl"
#include "shaders/lib/tool_winding.glsl"
#include "shaders/lib/sample_levels.glsl"
SAMPLE_WEIGHT(mockup_weight, mockup_levels, scene.mockup.triangles)

bool inside_tool(ivec3 point, ivec3 at) {
  const ivec3 voxel = body_voxel_of(at);
  const uint32_t voxel_class = body_class_of(voxel);
  if (voxel_class != kVoxelBoundary) return voxel_class == kVoxelInternal;
  return CLOSED ? tool_winding(point) != 0 : body_vote_inside(at, voxel);
}

struct Asked {
  ivec3 point, at;   // world lattice, tool lattice
  uint32_t entry, id, weight;
};

// False: it does not count.
bool asked_of(bool extra, uint32_t item, out Asked asked) {
  if (extra) {
    const FieldPoint work = mockup_points[item];
    asked.point = work.point;
    asked.entry = work.triangle;
    asked.id = static_id(asked.entry);
    asked.weight = work.weight;
    take_pose(static_pose(asked.entry));
  } else {
    const FrameSample work = frame_samples[item];
    asked.point = work.point;
    asked.entry = work.static_id;
    asked.id = static_id(asked.entry);
    take_pose(static_pose(asked.entry));
    if (!in_contact()) return false;
    const uint32_t axis = mockup_info[asked.id] >> kInfoAxisShift & 3u;
    const ivec2 ij = cell_of_sample(
        ivec2(asked.point[(axis + 1u) % 3u], asked.point[(axis + 2u) % 3u]), scene.sample_spacing);
    asked.weight = uint32_t(mockup_weight(asked.id, mockup_weights[asked.id], ij) >> 6);
  }
  asked.at = tool_from_world(asked.point);
  return asked.weight != 0u && (!extra || inside_tool(asked.point, asked.at));
}

// False: nothing pushes.
bool push_of(Asked asked, Depth depth, out Push push) {
  const uint32_t entry = asked.entry, id = asked.id, weight = asked.weight;
  if (depth.triangle == kNone || is_ignored(id)) return false;
  push.at = asked.point;
  push.against = -turned(body_normals[depth.triangle]);
  push.sheet = (mockup_info[id] & kInfoSheet) != 0u;
  push.along = push.sheet ? push.against : mockup_normals[id];
  push.depth = uint32_t(depth.steps);
  push.weight = weight;
  const bool thin = (mockup_info[id] & kInfoThin) != 0u,
             in_thin = (body_info[depth.triangle] & kInfoThin) != 0u;
  push.counted = push.sheet || (thin && !in_thin) ? weight
                 : thin == in_thin               ? weight >> 1
                                                 : 0u;
  push.static_id = id;
  push.mobile = depth.triangle;
  // CST and EST carry.
  push.slot = (static_state[entry] & (kStaticHit | kStaticSampled)) != 0u ? static_slot[entry] : kNone;
  return true;
}

void main() {
  const uint32_t samples = list_count(kListSamples), rounded = groups_to(samples) * kGroupSize;
  const uint32_t i = pushing_item();
  const bool extra = i >= rounded;
  Asked asked;
  const bool counts = (extra ? i - rounded < list_count(kListMockupPoints) : i < samples) &&
                      asked_of(extra, extra ? i - rounded : i, asked);
  const Depth depth = body_depth(counts, asked.at);
  Push push;
  const bool pushes = counts && speaks() && push_of(asked, depth, push);
  add_pushes(pushes, push);
}
