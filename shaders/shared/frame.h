// What a frame reads, keeps and leaves: structs, binding numbers, lists and states, for GLSL and C++ alike.
//
// One descriptor set (set 0); a binding number names one buffer for all shaders: scene.h has 0…31, this file 32…71,
// frame_response.h 72 and above. A shader declares the buffers that it uses and no other.
//
// *Lists.* Everything of unknown length is a list: a buffer of items and a FrameList (count, capacity, group counts).
//   append:  uint i = atomicAdd(frame_lists[kListPairs].count, 1u); if (i < frame_lists[kListPairs].capacity) pairs[i] = …;
//   close:   one invocation of list_close.comp per list, after the dispatch that appends and before anyone reads: it clamps
//            `count` to `capacity`, notes an overflow, and works out both indirect group counts. Readers: `if (i >= count) return`.
// Orders inside lists differ from run to run; nothing that leaves the frame may depend on them.
//
// *Groups.* Workgroups are kGroupSize wide and dispatches at most kMaxGroupsX × n: the flat group number is
// gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x (lib/frame.glsl: flat_group(), flat_invocation()).
#ifndef PALPATE_SHADERS_SHARED_FRAME_H
#define PALPATE_SHADERS_SHARED_FRAME_H
#include "language.h"

PALPATE_SHARED_BEGIN

PALPATE_CONST uint kGroupSize = 64;        // invocations of every workgroup (chosen: two warps, eight llvmpipe vectors)
PALPATE_CONST uint kMaxGroupsX = 65535;    // Vulkan's smallest maxComputeWorkGroupCount
PALPATE_CONST uint kClusterSize = 64;      // tool triangles in a cluster; the last one may be short
PALPATE_CONST uint kMaxFrameAreas = 256;   // kMaxAreas of model/contacts.h
PALPATE_CONST uint kNone = 0xFFFFFFFFu;    // no item

// ---- bindings ------------------------------------------------------------------------------------------------------------

PALPATE_CONST int kBindFrameInput = 32;        // FrameInput, one; mapped, written by the host
PALPATE_CONST int kBindFrameLists = 33;        // FrameList[kListCount]
PALPATE_CONST int kBindFrameState = 34;        // FrameState, one
PALPATE_CONST int kBindDispatches = 35;        // DispatchArguments[kDispatchCount]: the response's, set by frame_sets.comp
PALPATE_CONST int kBindToolVertices = 36;      // ivec3[tool vertices]: transformed, world lattice
PALPATE_CONST int kBindClusterBoxes = 37;      // LatticeBox[clusters]: of the transformed triangles of a cluster, closed
PALPATE_CONST int kBindMobileState = 38;       // uint[tool triangles]: kMobile… bits; rewritten every frame
PALPATE_CONST int kBindClusterBricks = 39;     // kListClusterBricks: ClusterBrick
PALPATE_CONST int kBindTriangleBricks = 40;    // kListTriangleBricks: TriangleBrick
PALPATE_CONST int kBindTouchCandidates = 41;   // kListTouchCandidates: TouchCandidate
PALPATE_CONST int kBindVoxelState = 42;        // uint[boundary voxels]: kVoxel… bits; 0 between frames
PALPATE_CONST int kBindTouchedVoxels = 43;     // kListTouchedVoxels: FrameVoxel, each V_bnd voxel touched by a mobile triangle once
PALPATE_CONST int kBindVoxelChunks = 44;       // kListVoxelChunks: ListChunk over the touched voxels (for BST)
PALPATE_CONST int kBindPairChunks = 45;        // kListPairChunks: ListChunk with the mobile triangle as owner
PALPATE_CONST int kBindPairTable = 46;         // uint64_t[2^n]: hash of pairs under test; 0 between frames
PALPATE_CONST int kBindPairCandidates = 47;    // kListPairCandidates: PairCandidate
PALPATE_CONST int kBindPairs = 48;             // kListPairs: ContactPair, distinct intersecting pairs
PALPATE_CONST int kBindStaticState = 49;       // uint[static triangles]: kStatic… bits; 0 between frames
PALPATE_CONST int kBindStaticSlot = 50;        // uint[static triangles]: position in contact_statics; valid where the state is not 0
PALPATE_CONST int kBindContactStatics = 51;    // kListContactStatics: uint static id = C_s
PALPATE_CONST int kBindContactMobiles = 52;    // kListContactMobiles: uint tool triangle = C_m
PALPATE_CONST int kBindSampleChunks = 53;      // kListSampleChunks: ListChunk over voxels that may hold inside samples
PALPATE_CONST int kBindOpenSamples = 54;       // kListOpenSamples: FrameSample in V_bnd voxels of the tool: the winding decides
PALPATE_CONST int kBindSamples = 55;           // kListSamples: FrameSample that count (inside; or the rule for open tools); refined only
PALPATE_CONST int kBindHeldStatics = 56;       // HeldStatic[FrameInput::held_statics]; mapped
PALPATE_CONST int kBindHeldAreas = 57;         // HeldDirection[FrameInput::held_areas]; mapped
PALPATE_CONST int kBindResult = 58;            // FrameResult, one; mapped, read by the host
PALPATE_CONST int kBindResultStatics = 59;     // StaticResult[C_s], by slot; mapped
PALPATE_CONST int kBindResultMobiles = 60;     // MobileResult[C_m], by position; mapped
PALPATE_CONST int kBindResultMembers = 61;     // kListMembers: AreaMember; mapped
PALPATE_CONST int kBindResultPierces = 62;     // kListPierces: AreaPierce; mapped
PALPATE_CONST int kBindResponseFirst = 72;     // frame_response.h has this one and above

// ---- lists ---------------------------------------------------------------------------------------------------------------

PALPATE_CONST uint kListClusterBricks = 0;
PALPATE_CONST uint kListTriangleBricks = 1;
PALPATE_CONST uint kListTouchCandidates = 2;
PALPATE_CONST uint kListTouchedVoxels = 3;
PALPATE_CONST uint kListVoxelChunks = 4;
PALPATE_CONST uint kListPairChunks = 5;
PALPATE_CONST uint kListPairCandidates = 6;
PALPATE_CONST uint kListPairs = 7;
PALPATE_CONST uint kListContactStatics = 8;
PALPATE_CONST uint kListContactMobiles = 9;
PALPATE_CONST uint kListSampleChunks = 10;
PALPATE_CONST uint kListOpenSamples = 11;
PALPATE_CONST uint kListSamples = 12;
PALPATE_CONST uint kListMembers = 13;       // response: mobile triangles of areas; ids only, goes to the host as it is
PALPATE_CONST uint kListPierces = 14;       // response: distinct (area, pierced area); goes to the host as it is
PALPATE_CONST uint kListResponseFirst = 16; // 16…31: lists of frame_response.h
PALPATE_CONST uint kListCount = 32;

// An overflow is a bit of FrameState::overflow: 1 << list for a list, and in overflow_other:
PALPATE_CONST uint kOverflowPairTable = 1u << 0;   // no free slot near a pair's own in the table
PALPATE_CONST uint kOverflowAreas = 1u << 1;       // more than kMaxFrameAreas
PALPATE_CONST uint kOverflowLoop = 1u << 2;        // an invocation would have run beyond kLoopBudget
PALPATE_CONST uint kOverflowResponseFirst = 1u << 8;   // bits 8…31: frame_response.h
PALPATE_CONST uint kLoopBudget = 30000;     // loop iterations of one invocation, all its loops together (llvmpipe ends loops silently at 65,535)

struct DispatchArguments {
  uint x, y, z;
};

struct FrameList {
  uint count;                  // items; while being filled it may run beyond `capacity`
  uint asked;                  // items that were asked for, set at closing
  uint capacity;               // items that fit; written once by the host
  DispatchArguments items;     // groups of kGroupSize invocations for one invocation an item; set at closing
  DispatchArguments groups;    // groups for one workgroup an item; set at closing
};

// Group counts for the response; all 0 in a frame that does not need them. `One` is a single workgroup.
PALPATE_CONST uint kDispatchContactOne = 0;       // contact
PALPATE_CONST uint kDispatchContactStatics = 1;   // contact: an invocation a slot of C_s
PALPATE_CONST uint kDispatchContactMobiles = 2;   // contact: an invocation a member of C_m
PALPATE_CONST uint kDispatchContactMobileGroups = 3;   // contact: a workgroup a member of C_m
PALPATE_CONST uint kDispatchSamples = 4;          // contact: an invocation a counting sample (refined)
PALPATE_CONST uint kDispatchSampleGroups = 5;     // contact: a workgroup a counting sample (refined)
PALPATE_CONST uint kDispatchPairs = 6;            // contact: an invocation a pair
PALPATE_CONST uint kDispatchTouchedVoxels = 7;    // contact: an invocation a touched V_bnd voxel
PALPATE_CONST uint kDispatchContactStaticGroups = 8;   // contact: a workgroup a slot of C_s
PALPATE_CONST uint kDispatchHeldStatics = 9;      // contact: an invocation a HeldStatic
PALPATE_CONST uint kDispatchSwallowedOne = 10;    // swallowed: a single workgroup
PALPATE_CONST uint kDispatchSwallowed = 11;       // swallowed: a workgroup a TriangleBrick
PALPATE_CONST uint kDispatchPairGroups = 12;      // contact: a workgroup a pair
PALPATE_CONST uint kDispatchResponseFirst = 16;   // 16…31: of the response's own making
PALPATE_CONST uint kDispatchCount = 32;

// ---- what the host gives a frame -----------------------------------------------------------------------------------------

struct FrameInput {
  int rotation_q30[9];     // row-major, world from tool (LatticePose)
  ivec3 translation;       // steps
  ivec3 brick_first;       // bricks of the mock-up's grid that the tool's box can meet …
  ivec3 brick_last;        // … inclusive; the host submits nothing when there are none
  ivec3 last_direction;    // Held::last_direction, 0: none
  uint held_areas;         // entries of held areas, in the order of Held::areas
  uint held_statics;       // entries of held statics
};

struct HeldStatic {
  uint static_id;
  uint held_area;          // position in held areas
};

struct HeldDirection {
  ivec3 direction;
  int sheet_sign;
};

// ---- what it keeps -------------------------------------------------------------------------------------------------------

struct FrameState {
  uint overflow;           // bit per list
  uint overflow_other;     // kOverflow… bits
  uint contact;            // 1: CST, IMT or EST is not empty
  uint swallowed;          // 1: C_s empty, IMT not (refined)
  uint cst, bst, est, cmt, bmt, imt;   // sizes of the sets
};

struct LatticeBox {
  ivec3 low, high;         // closed; low > high: empty
};

// States of a static triangle. CST wins over BST when sets are named; EST may be in BST too.
PALPATE_CONST uint kStaticHit = 1u;        // in an intersecting pair: CST
PALPATE_CONST uint kStaticListed = 2u;     // listed in a touched V_bnd voxel: BST unless CST
PALPATE_CONST uint kStaticSampled = 4u;    // a sample inside the tool: EST unless CST (refined)

// States of a tool triangle at this pose. CMT wins, then IMT, then BMT.
PALPATE_CONST uint kMobileHit = 1u;        // in an intersecting pair: CMT
PALPATE_CONST uint kMobileInternal = 2u;   // touches a V_int voxel: IMT unless CMT
PALPATE_CONST uint kMobileBoundary = 4u;   // touches a V_bnd voxel: BMT in neither
PALPATE_CONST uint kMobileVoid = 8u;       // collapsed at load or collinear at this pose: in no set, rays do not see it
PALPATE_CONST uint kMobileSets = 7u;       // any of the first three: in C_m

PALPATE_CONST uint kVoxelTouched = 1u;     // in touched voxels
PALPATE_CONST uint kVoxelSampled = 2u;     // its samples are being looked at

struct ClusterBrick {
  uint cluster;
  uint brick;              // linear brick number
};

// A tool triangle whose closed transformed point set meets the closed cube of a brick that is mixed or interior.
struct TriangleBrick {
  uint mobile;
  uint brick;
};

struct TouchCandidate {
  uint mobile;
  uint brick;
  uint local;              // voxel within the brick, x fastest, 0…511
};

// A V_bnd voxel of the mock-up's grid.
struct FrameVoxel {
  uint boundary;           // its number among V_bnd voxels: state and list
  ivec3 voxel;             // coordinates in the grid
};

// At most kChunk… entries of a voxel's list of static triangles: [begin, end) in the list buffer.
struct ListChunk {
  uint owner;              // tool triangle (pair chunks), else position in the voxels that the chunk belongs to
  uint boundary;
  uint begin, end;
};
PALPATE_CONST uint kPairChunk = 8;         // entries a pair chunk (chosen: most lists are shorter)
PALPATE_CONST uint kVoxelChunk = 32;       // entries a voxel chunk

struct PairCandidate {
  uint static_id;
  uint mobile;
  uint slot;               // in the pair table, to be emptied at the end of the frame
};

struct ContactPair {
  uint static_id;
  uint mobile;
};

struct FrameSample {
  ivec3 point;             // world lattice
  uint static_id;          // its triangle; the weight is the triangle's
};

// ---- what it leaves to the host ------------------------------------------------------------------------------------------

// ContactArea without its lists; equal names mean the same. Area numbers of a frame are in no particular order: the host
// sorts by id and renumbers.
struct AreaResult {
  uint id;                 // smallest static id
  uint flags;              // ContactFlag bits of model/contacts.h
  ivec3 direction;
  int sheet_sign;
  uint rays;
  uint max_height;
  int64_t weight_sum;
  int64_t height_sum;
  int64_t moment_low[3];   // WideSum::low
  int64_t moment_high[3];  // WideSum::high
  int64_t voxel_sum[3];
  uint voxel_count;
  uint padding;
};

struct FrameResult {
  FrameState state;
  uint flags;                    // ContactFlag bits of the frame itself (swallowed and its rule)
  uint pair_count;
  uint static_count;             // entries of the statics' results
  uint mobile_count;             // entries of the mobiles' results
  uint member_count;             // entries of the members
  uint pierce_count;
  uint area_count;               // ≤ kMaxFrameAreas
  ivec3 swallowed_direction;
  uint swallowed_height;
  uint padding;
  AreaResult areas[kMaxFrameAreas];
};

struct StaticResult {
  uint id;
  uint state;              // kStatic… bits
  uint area;               // area number of this frame; kNone without contact (the response writes it)
  uint zone;               // equal for triangles of one zone, different between zones (the response writes it)
};

struct MobileResult {
  uint id;
  uint state;              // kMobile… bits
};

struct AreaMember {
  uint area;
  uint mobile;
};

struct AreaPierce {
  uint area;               // has a ray that …
  uint pierced;            // … leaves this area's surface before it leaves the tool
};

PALPATE_SHARED_END
#endif
