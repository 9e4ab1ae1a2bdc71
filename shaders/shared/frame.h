// What a frame reads, keeps and leaves: structs, binding numbers, lists and states, for GLSL and C++ alike.
//
// One descriptor set (set 0); a binding number names one buffer for all shaders of a frame: 0…31 the prepared
// scene, 32…71 the frame, 72 and above the response (frame_response.h, frame_field.h). A shader declares the
// buffers that it uses and no other, with READ or EDIT of lib/frame.glsl; compute/gpu/frame/recorder.h binds
// them by these numbers.
//
// *Lists.* Everything of unknown length is a list: a buffer of items and a FrameList (count, capacity, group
// counts).
//   append:  uint i = atomicAdd(frame_lists[kListPairs].count, 1u);
//            if (i < frame_lists[kListPairs].capacity) pairs[i] = …;
// `count` runs beyond `capacity` where there is no room: whoever crosses it notes an overflow
// (lib/list_room.glsl). Readers ask list_count().
//
// *Stages.* Dispatches of a stage run beside each other; a barrier follows. Whoever appends an item that
// begins a new workgroup of a later stage raises that stage's group count (lib/group_count.glsl), so no
// dispatch works sizes out, and what has nothing to do has no workgroups. A stage's group counts lie in
// buffers of their own, which are read, as the device's commands, while no shader writes them. Orders inside
// lists differ from run to run; nothing that leaves the frame may depend on them.
//
// *Groups.* Workgroups are kGroupSize wide and dispatches at most kMaxGroupsX × n: the flat group number is
// gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x (lib/frame.glsl: flat_group(), flat_invocation()).
#ifndef PALPATE_SHADERS_SHARED_FRAME_H
#define PALPATE_SHADERS_SHARED_FRAME_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN

PALPATE_CONSTANT uint32_t kGroupSize =
    64;  // invocations of every workgroup (chosen: two warps, eight llvmpipe vectors)
PALPATE_CONSTANT uint32_t kMaxGroupsX = 65535;   // Vulkan's smallest maxComputeWorkGroupCount
PALPATE_CONSTANT uint32_t kClusterSize = 64;     // tool triangles in a cluster; the last one may be short
PALPATE_CONSTANT uint32_t kRunSize = 8;          // tool triangles in a run; 8 runs make a cluster
PALPATE_CONSTANT uint32_t kMaxFrameAreas = 256;  // kMaxAreas of model/contact/contacts.h
PALPATE_CONSTANT uint32_t kNone = 0xFFFFFFFFu;   // no item

// Ids of what lib/frame.glsl lets the host choose.
PALPATE_CONSTANT uint32_t kLanesConstant = 21, kRunsAGroupConstant = 22, kPairChunkConstant = 23,
                          kListedChunkConstant = 24, kFieldTileConstant = 25;

// ---- bindings
// ------------------------------------------------------------------------------------------------------------

// The prepared scene (compute/gpu/prepare/prepared_scene.h).
PALPATE_CONSTANT int32_t kBindScene = 0;                 // SceneConstants, one
PALPATE_CONSTANT int32_t kBindMockupVertices = 1;        // ivec3
PALPATE_CONSTANT int32_t kBindMockupTriangles = 2;       // uvec3
PALPATE_CONSTANT int32_t kBindMockupInfo = 3;            // uint32_t: kInfo… bits
PALPATE_CONSTANT int32_t kBindMockupNormals = 4;         // ivec3, Q30
PALPATE_CONSTANT int32_t kBindMockupWeights = 5;         // uint32_t, Q30: field weights; refined
PALPATE_CONSTANT int32_t kBindNeighbourBegin = 6;        // uint32_t
PALPATE_CONSTANT int32_t kBindNeighbours = 7;            // uint32_t: id · 2 + smooth
PALPATE_CONSTANT int32_t kBindMockupPatches = 8;         // uint32_t; refined
PALPATE_CONSTANT int32_t kBindMockupExtras = 9;          // ExtraSample, ascending by triangle; refined
PALPATE_CONSTANT int32_t kBindMockupBrickSlot = 10;      // uint32_t
PALPATE_CONSTANT int32_t kBindMockupBricks = 11;         // Brick
PALPATE_CONSTANT int32_t kBindMockupListBegin = 12;      // uint32_t, by boundary voxel
PALPATE_CONSTANT int32_t kBindMockupListTriangles = 13;  // uint32_t
PALPATE_CONSTANT int32_t kBindMockupBoundaryPlace = 14;  // uint32_t: slot · 512 + bit of a boundary voxel
PALPATE_CONSTANT int32_t kBindMockupMixedBrick = 15;     // uint32_t: brick number of a slot
PALPATE_CONSTANT int32_t kBindToolVertices = 16;         // ivec3, tool lattice frame
PALPATE_CONSTANT int32_t kBindToolTriangles = 17;        // uvec3
PALPATE_CONSTANT int32_t kBindToolInfo = 18;             // uint32_t: kInfo… bits
PALPATE_CONSTANT int32_t kBindToolNormals = 19;          // ivec3, Q30, tool lattice frame
PALPATE_CONSTANT int32_t kBindToolWeights = 20;          // uint32_t, Q30: field weights; refined
PALPATE_CONSTANT int32_t kBindToolExtras = 21;           // ExtraSample, tool lattice frame; refined
PALPATE_CONSTANT int32_t kBindSampleBegin = 22;  // uint32_t, by boundary voxel of the mock-up, and one more:
                                                 // the first of its points (of the next three)
PALPATE_CONSTANT int32_t kBindFineBrickSlot = 23;  // the tool's fine partition (SceneConstants::fine) …
PALPATE_CONSTANT int32_t kBindFineBricks = 24;
PALPATE_CONSTANT int32_t kBindFineListBegin = 25;
PALPATE_CONSTANT int32_t kBindFineListTriangles = 26;
PALPATE_CONSTANT int32_t kBindFineExit =
    27;  // uint32_t, by V_bnd voxel of it: the axis step (0 … 5: −x, +x, −y …) that leads out to V_ext
PALPATE_CONSTANT int32_t kBindSamplePoints =
    28;  // uint32_t: grid samples and first corners of the mock-up's triangles from their voxel's low corner
         // on: x + 2^20 · y + 2^40 · z as two words where a voxel has no more than kNarrowVoxel steps, else
         // three
PALPATE_CONSTANT int32_t kBindSampleIds = 29;  // uint32_t: their triangles, as in FrameSample
PALPATE_CONSTANT int32_t kBindToolNear =
    30;  // uint32_t: a bit a voxel of SceneConstants::fine: a mock-up voxel
         // with its centre there may meet the tool's solid; or one word: all
PALPATE_CONSTANT int32_t kBindFinePlaces =
    31;  // uint32_t: kBindFineListTriangles as places in the order of clusters; of a closed tool (refined)

// The frame.
PALPATE_CONSTANT int32_t kBindFrameInput = 32;    // FrameInput, one; mapped, written by the host
PALPATE_CONSTANT int32_t kBindFrameLists = 33;    // FrameList[kListCount]
PALPATE_CONSTANT int32_t kBindFrameState = 34;    // FrameState, one
PALPATE_CONSTANT int32_t kBindDispatches = 35;    // DispatchArguments[kDispatchCount]: of `paper`'s response
PALPATE_CONSTANT int32_t kBindListedGroups = 39;  // DispatchArguments: kGroupsPairs, kGroupsOpen
PALPATE_CONSTANT int32_t kBindMembersGroups =
    46;  // one: an invocation a slot of C_s, a member of C_m, a sample
PALPATE_CONSTANT int32_t kBindPlacedGroups = 56;  // one: kFieldTileLanes invocations a tile
PALPATE_CONSTANT int32_t kBindPushedGroups = 57;  // kGroupsToolPush, kGroupsMockupPush
PALPATE_CONSTANT int32_t kBindResultGroups =
    62;  // one: an invocation an entry of whatever the host gets, and of whatever is emptied
PALPATE_CONSTANT int32_t kBindListsAnew = 36;  // BatchLists of frame_batch.h, one
PALPATE_CONSTANT int32_t kBindClusterBoxes =
    37;  // LatticeBox[clusters]: of the transformed triangles of a cluster, closed
PALPATE_CONSTANT int32_t kBindMobileState = 38;  // uint32_t[tool triangles]: kMobile… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindToolRecords = 40;  // ToolRecord[tool triangles], in the order of clusters
PALPATE_CONSTANT int32_t kBindNearRuns = 41;     // kListNearRuns: NearRun
PALPATE_CONSTANT int32_t kBindVoxelState = 42;  // uint32_t[boundary voxels]: kVoxel… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindTouchedVoxels =
    43;  // kListTouchedVoxels: FrameVoxel, each V_bnd voxel touched by a mobile triangle once
PALPATE_CONSTANT int32_t kBindPairChunks = 45;   // kListPairChunks: PairChunk
PALPATE_CONSTANT int32_t kBindToolSamples = 63;  // uint32_t, by tool triangle: its grid samples that weigh
                                                 // something; refined only
PALPATE_CONSTANT int32_t kBindPairTable = 47;    // uint64_t[a power of two]: hash table of pairs to test,
                                                 // (static id + 1) · 2^32 + place; 0 between frames
PALPATE_CONSTANT int32_t kBindPairs = 48;        // kListPairs: ContactPair, distinct intersecting pairs
PALPATE_CONSTANT int32_t kBindStaticState =
    49;  // uint32_t[static triangles]: kStatic… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindStaticSlot =
    50;  // uint32_t[static triangles]: position in contact_statics; valid where the state is not 0
PALPATE_CONSTANT int32_t kBindContactStatics = 51;  // kListContactStatics: uint32_t static id = C_s
PALPATE_CONSTANT int32_t kBindContactMobiles = 52;  // kListContactMobiles: uint32_t tool triangle = C_m
PALPATE_CONSTANT int32_t kBindSampleChunks =
    53;  // kListSampleChunks: SampleChunk over voxels that may hold counting samples
PALPATE_CONSTANT int32_t kBindOpenSamples =
    54;  // kListOpenSamples: FrameSample in V_bnd voxels of the tool: the winding decides
PALPATE_CONSTANT int32_t kBindSamples = 55;        // kListSamples: FrameSample inside the tool; refined only
PALPATE_CONSTANT int32_t kBindResult = 58;         // FrameResult, one; mapped, read by the host
PALPATE_CONSTANT int32_t kBindResultStatics = 59;  // StaticResult[C_s], by slot; mapped
PALPATE_CONSTANT int32_t kBindResultMobiles = 60;  // MobileResult[C_m], by position; mapped
PALPATE_CONSTANT int32_t kBindResultMembers = 61;  // kListMembers: AreaMember; mapped
PALPATE_CONSTANT int32_t kBindToolCorners =
    65;  // ToolCorners[tool triangles]: transformed, in the order of clusters
PALPATE_CONSTANT int32_t kBindRunBoxes =
    66;  // LatticeBox[runs]: of kRunSize triangles that follow each other in a cluster
PALPATE_CONSTANT int32_t kBindPairSlots = 67;   // kListPairCandidates: uint32_t entries of the table in use
PALPATE_CONSTANT int32_t kBindToolBounds = 68;  // LatticeBox: of each cluster, then of each run, tool lattice
                                                // frame, without what has collapsed; may be empty
PALPATE_CONSTANT int32_t kBindOccupied = 69;    // uint32_t: lib/broad_phase/occupied.glsl
PALPATE_CONSTANT int32_t kBindListBoxes =
    70;  // uint32_t, by entry of kBindMockupListTriangles: the part of the voxel in which the triangle's box
         // lies, low x, y, z, high x, y, z in kListParts-ths of its side, 5 bits each
PALPATE_CONSTANT int32_t kBindNearGroups = 71;  // kGroupsTouch, kGroupsSamples
PALPATE_CONSTANT int32_t kBindResponseFirst =
    72;  // frame_response.h has this one and above, frame_field.h 96 and above, frame_batch.h 112 and above

// ---- lists
// ---------------------------------------------------------------------------------------------------------------

// 0: frame_batch.h
PALPATE_CONSTANT uint32_t kListDone = 1;  // its count: workgroups of a frame's last stage that are done
PALPATE_CONSTANT uint32_t kListNearRuns = 2;
PALPATE_CONSTANT uint32_t kListTouchedVoxels = 3;
PALPATE_CONSTANT uint32_t kListPairChunks = 5;
PALPATE_CONSTANT uint32_t kListPairCandidates = 6;
PALPATE_CONSTANT uint32_t kListPairs = 7;
PALPATE_CONSTANT uint32_t kListContactStatics = 8;
PALPATE_CONSTANT uint32_t kListContactMobiles = 9;
PALPATE_CONSTANT uint32_t kListSampleChunks = 10;
PALPATE_CONSTANT uint32_t kListOpenSamples = 11;
PALPATE_CONSTANT uint32_t kListSamples = 12;
PALPATE_CONSTANT uint32_t kListMembers =
    13;  // response: mobile triangles of areas; ids only, goes to the host as it is
PALPATE_CONSTANT uint32_t kListIgnored = 19;        // response: ignored patches that something touched
PALPATE_CONSTANT uint32_t kListResponseFirst = 16;  // 16…31: lists of frame_field.h
PALPATE_CONSTANT uint32_t kListCount = 32;

// An overflow is a bit of FrameState::overflow: 1 << list for a list, and in overflow_other:
PALPATE_CONSTANT uint32_t kOverflowAfterSets =
    0xFFFF2000u;  // lists that fill when the sets are known: kListMembers, kListResponseFirst and above
PALPATE_CONSTANT uint32_t kOverflowAreas = 1u << 1;  // more than kMaxFrameAreas
PALPATE_CONSTANT uint32_t kOverflowLoop = 1u << 2;   // an invocation would have run beyond kLoopBudget
PALPATE_CONSTANT uint32_t kLoopBudget = 30000;  // loop iterations of one invocation, all its loops together
                                                // (llvmpipe ends loops silently at 65,535)

struct DispatchArguments {
  uint32_t x, y, z;
};

struct FrameList {
  uint32_t count;     // items; while being filled it may run beyond `capacity`
  uint32_t capacity;  // items that fit; written by the host
};

// Entries of the stages' group counts.
PALPATE_CONSTANT uint32_t kGroupsTouch = 0;       // a workgroup RUNS_A_GROUP NearRuns
PALPATE_CONSTANT uint32_t kGroupsSamples = 1;     // an invocation a SampleChunk
PALPATE_CONSTANT uint32_t kGroupsPairs = 0;       // an invocation a PairChunk
PALPATE_CONSTANT uint32_t kGroupsOpen = 1;        // LANES invocations an open sample
PALPATE_CONSTANT uint32_t kGroupsToolPush = 0;    // LANES invocations a sample of the tool that weighs
PALPATE_CONSTANT uint32_t kGroupsMockupPush = 1;  // likewise of the mock-up

// Group counts; 0 in a frame that does not need them. `One` is a single workgroup.
PALPATE_CONSTANT uint32_t kDispatchContactOne = 0;       // contact
PALPATE_CONSTANT uint32_t kDispatchContactStatics = 1;   // contact: an invocation a slot of C_s
PALPATE_CONSTANT uint32_t kDispatchContactMobiles = 2;   // contact: an invocation a member of C_m
PALPATE_CONSTANT uint32_t kDispatchContactClusters = 3;  // contact: a workgroup a cluster of the tool
PALPATE_CONSTANT uint32_t kDispatchTouchedVoxels = 7;    // contact: an invocation a touched V_bnd voxel
PALPATE_CONSTANT uint32_t kDispatchResponseFirst = 16;   // 16…31: of the response's own making
PALPATE_CONSTANT uint32_t kDispatchCount = 32;

// ---- what the host gives a frame
// -----------------------------------------------------------------------------------------

struct FrameInput {
  int32_t rotation_q30[9];  // row-major, world from tool (LatticePose)
  ivec3 translation;        // steps
  uint32_t ignores;         // 1: some patch is ignored (refined)
  uint32_t coarser;  // 256ths of a level by which samples are coarser than the contact asks for (refined)
};

// ---- what it keeps
// -------------------------------------------------------------------------------------------------------

struct FrameState {
  uint32_t overflow;        // bit per list
  uint32_t overflow_other;  // kOverflow… bits
  uint32_t contact;  // 1: CST, IMT or EST is not empty, and nothing overflowed before they were known; set at
                     // the end (lib/list_room.glsl: in_contact())
  uint32_t meets;    // 1: something was marked that is in CST, IMT or EST
  uint32_t cst, bst, est, cmt, bmt, imt;      // sizes of the sets
  uint32_t deep_samples, cut_samples;         // of triangles in IMT, in CMT: kBindToolSamples (refined)
  uint32_t pairs, samples, statics, mobiles;  // of a batch's pose: how many it has in the lists of all poses
};
// Samples are rounded by less than a step, transformed corners too. Bodies that keep this distance have no
// sample on the wrong side of each other's surface.
PALPATE_CONSTANT int32_t kCloseSteps = 3;

struct LatticeBox {
  ivec3 low, high;  // closed; low > high: empty
};

// A tool triangle at this pose. A void one has all its corners in one place: no ray crosses it.
struct ToolCorners {
  ivec3 a, b, c;
};

// States of a static triangle. CST wins over BST when sets are named; EST may be in BST too.
PALPATE_CONSTANT uint32_t kStaticHit = 1u;      // in an intersecting pair: CST
PALPATE_CONSTANT uint32_t kStaticListed = 2u;   // listed in a touched V_bnd voxel: BST unless CST
PALPATE_CONSTANT uint32_t kStaticSampled = 4u;  // a sample inside the tool: EST unless CST (refined)

// States of a tool triangle at this pose. CMT wins, then IMT, then BMT.
PALPATE_CONSTANT uint32_t kMobileHit = 1u;       // in an intersecting pair: CMT
PALPATE_CONSTANT uint32_t kMobileInternal = 2u;  // touches a V_int voxel: IMT unless CMT
PALPATE_CONSTANT uint32_t kMobileBoundary = 4u;  // touches a V_bnd voxel: BMT in neither
PALPATE_CONSTANT uint32_t kMobileSets = 7u;      // any of the first three: in C_m

PALPATE_CONSTANT uint32_t kVoxelTouched = 1u;  // in touched voxels

// A tool triangle as it was loaded, tool lattice frame.
struct ToolRecord {
  ivec3 a;
  uint32_t id;
  ivec3 b;
  uint32_t info;  // kInfo… bits
  ivec3 c;
  uint32_t padding;
};

// A run of the tool near the mock-up; of its triangles' voxels those in bricks low … high along each axis, so
// that no invocation walks too many.
struct NearRun {
  uint32_t run;
  uint32_t x, y, z;  // low + 2^16 · high
  uint32_t pose;     // of a batch
};
PALPATE_CONSTANT int32_t kBricksAPart = 64;     // of a NearRun (chosen), …
PALPATE_CONSTANT int32_t kMostParts = 1 << 14;  // … and more where so many parts would not do

// A V_bnd voxel of the mock-up's grid.
struct FrameVoxel {
  uint32_t boundary;  // its number among V_bnd voxels: state and list; of a batch: entry of the tables
  ivec3 voxel;        // coordinates in the grid
};

// Entries [begin, end) of the list of a V_bnd voxel that a tool triangle touches, so that no invocation walks
// a long list.
struct PairChunk {
  uint32_t place;  // of the tool triangle, in the order of clusters; with kFirstTouch: none touched the voxel
                   // before, and all that it lists is to be marked
  uint32_t begin, end;
  uint32_t xy, z;  // voxel x + 2^16 · voxel y, voxel z
  uint32_t pose;   // of a batch
};
PALPATE_CONSTANT uint32_t kFirstTouch = 1u << 31;
PALPATE_CONSTANT int32_t kListParts = 32;
struct SampleChunk {
  ivec3 voxel;          // whose samples are asked for; of a batch z + 2^16 · pose
  uint32_t begin, end;  // of its list, or of its points, where samples are listed
};
PALPATE_CONSTANT uint32_t kSampleChunk = 2;       // entries in a SampleChunk where points are not listed
PALPATE_CONSTANT int32_t kNarrowVoxel = 1 << 20;  // steps
PALPATE_CONSTANT uint32_t kMostChunks = 1024,
                          kMostSampleChunks = 1
                                              << 14;  // of one list: where it is very long, chunks are longer

struct ContactPair {
  uint32_t static_id;
  uint32_t mobile;
};

struct FrameSample {
  ivec3 point;         // world lattice
  uint32_t static_id;  // its triangle; the weight is the triangle's. With kCornerProbe: the point is the
                       // triangle's first corner (which is left out where it is known to lie inside), tells
                       // EST and does not count. In kListSamples, of a batch: entry of the tables
};
PALPATE_CONSTANT uint32_t kCornerProbe = 1u << 31;  // more triangles than this do not fit a lattice mesh

// ---- what it leaves to the host
// ------------------------------------------------------------------------------------------

// ContactArea of `paper` without its lists; equal names mean the same. Area numbers of a frame are in no
// particular order: the host sorts by id and renumbers.
struct AreaResult {
  uint32_t id;     // smallest static id
  uint32_t flags;  // ContactFlag bits of model/contact/contacts.h
  ivec3 direction;
  uint32_t rays;
  uint32_t max_height;
  uint32_t voxel_count;
  int64_t height_sum;
  int64_t voxel_sum[3];
};

struct FrameResult {
  FrameState state;
  uint32_t pair_count;
  uint32_t static_count;       // entries of the statics' results
  uint32_t mobile_count;       // entries of the mobiles' results
  uint32_t member_count;       // entries of the members
  uint32_t area_count;         // ≤ kMaxFrameAreas
  uint32_t ignored_count;      // entries of the ignored patches that something touched
  uint32_t asked[kListCount];  // items that each list was asked to hold
  AreaResult areas[kMaxFrameAreas];
};

struct StaticResult {
  uint32_t id;
  uint32_t state;  // kStatic… bits
  uint32_t area;   // area number of this frame; kNone without contact (the response writes it). Of a batch:
                   // the pose
  uint32_t zone;   // equal for triangles of one zone, different between zones (the response writes it). Of a
                   // batch: the slot
};

struct MobileResult {
  uint32_t id;
  uint32_t state;  // kMobile… bits
};

struct AreaMember {
  uint32_t area;
  uint32_t mobile;
};

PALPATE_ASSERT_SIZE(FrameList, 8);
PALPATE_ASSERT_SIZE(FrameInput, 56);
PALPATE_ASSERT_SIZE(ToolRecord, 48);
PALPATE_ASSERT_SIZE(NearRun, 20);
PALPATE_ASSERT_SIZE(PairChunk, 24);
PALPATE_ASSERT_SIZE(AreaResult, 64);
PALPATE_ASSERT_SIZE(FrameResult,
                    84 + 4 * kListCount + 4 + 64 * kMaxFrameAreas);  // areas begin at a multiple of 8

PALPATE_SHARED_END
#endif
