// What a batch has beside a frame: many poses in one submission, of the same dispatches. Every item of a list
// says of which pose it is, so lists have one capacity for all, and a dispatch covers them all. What a frame
// keeps by triangle or voxel is here a hash table by pose and number. Profile `refined` only.
//
// The shaders are a frame's, with the specialisation constant BATCH (lib/frame.glsl).
#ifndef PALPATE_SHADERS_SHARED_FRAME_BATCH_H
#define PALPATE_SHADERS_SHARED_FRAME_BATCH_H
#include "shaders/shared/base.h"
#include "shaders/shared/frame.h"

PALPATE_SHARED_BEGIN

PALPATE_CONSTANT uint32_t kBatchConstant = 20;  // id of BATCH

// In a batch FrameState and FieldWork have an entry a pose.
PALPATE_CONSTANT int32_t kBindBatchInputs = 112;  // FrameInput[poses]; mapped, written by the host
PALPATE_CONSTANT int32_t kBindStaticKeys = 113;  // uint64_t[a power of two]: pose · 2^32 + static id + 1, by
                                                 // entry of static_state and static_slot; 0 between batches
PALPATE_CONSTANT int32_t kBindMobileKeys = 114;  // likewise of tool triangles
PALPATE_CONSTANT int32_t kBindVoxelKeys = 115;   // likewise of V_bnd voxels
PALPATE_CONSTANT int32_t kBindOpenPoses = 116;   // uint32_t, by open sample: its pose
PALPATE_CONSTANT int32_t kBindResultStates = 117;  // FrameState[poses]; mapped, read by the host

PALPATE_CONSTANT uint32_t kListPoses = 0;  // its count: poses of this batch

PALPATE_CONSTANT uint32_t kMostProbes = 256;     // of a hash table, which is at most half full (chosen)
PALPATE_CONSTANT uint32_t kResultPoseShift = 8;  // MobileResult::state has the pose above its bits

// What lists and group counts of a batch begin with.
struct FrameLists {
  FrameList lists[kListCount];
  DispatchArguments result;  // as many workgroups as the fields of all poses take
};

// What buffers begin each batch with; mapped, written by the host.
struct BatchLists {
  FrameLists anew;
  DispatchArguments cull;  // workgroups that a pose is culled by, poses, 1
};

PALPATE_SHARED_END
#endif
