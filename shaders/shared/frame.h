// What a frame reads, keeps and leaves: structs, binding numbers, lists and states, for GLSL and C++ alike.
//
// One descriptor set (set 0); a binding number names one buffer for all shaders of a frame: 0…31 the prepared scene, 32…71 the
// frame, 72 and above the response (frame_response.h). A shader declares the buffers that it uses and no other, with
// READ or EDIT of lib/frame.glsl; compute/frame_recorder.h binds them by these numbers.
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
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN

PALPATE_CONSTANT uint32_t kGroupSize = 64;                       // invocations of every workgroup (chosen: two warps, eight llvmpipe vectors)
PALPATE_CONSTANT uint32_t kMaxGroupsX = 65535;                   // Vulkan's smallest maxComputeWorkGroupCount
PALPATE_CONSTANT uint32_t kClusterSize = 64;                     // tool triangles in a cluster; the last one may be short
PALPATE_CONSTANT uint32_t kRunSize = 8;                          // tool triangles in a run; 8 runs make a cluster
PALPATE_CONSTANT uint32_t kMaxFrameAreas = 256;                  // kMaxAreas of model/contacts.h
PALPATE_CONSTANT uint32_t kNone = 0xFFFFFFFFu;                   // no item

// ---- bindings ------------------------------------------------------------------------------------------------------------

// The prepared scene (compute/prepared_scene.h).
PALPATE_CONSTANT int32_t kBindScene = 0;               // SceneConstants, one
PALPATE_CONSTANT int32_t kBindMockupVertices = 1;      // ivec3
PALPATE_CONSTANT int32_t kBindMockupTriangles = 2;     // uvec3
PALPATE_CONSTANT int32_t kBindMockupInfo = 3;          // uint32_t: kInfo… bits
PALPATE_CONSTANT int32_t kBindMockupNormals = 4;       // ivec3, Q30
PALPATE_CONSTANT int32_t kBindMockupWeights = 5;       // uint32_t, Q30
PALPATE_CONSTANT int32_t kBindNeighbourBegin = 6;      // uint32_t
PALPATE_CONSTANT int32_t kBindNeighbours = 7;          // uint32_t: id · 2 + smooth
PALPATE_CONSTANT int32_t kBindSeamBegin = 8;           // uint32_t
PALPATE_CONSTANT int32_t kBindSeams = 9;               // uint32_t
PALPATE_CONSTANT int32_t kBindMockupBrickSlot = 10;    // uint32_t
PALPATE_CONSTANT int32_t kBindMockupBricks = 11;       // Brick
PALPATE_CONSTANT int32_t kBindMockupListBegin = 12;    // uint32_t, by boundary voxel
PALPATE_CONSTANT int32_t kBindMockupListTriangles = 13;   // uint32_t
PALPATE_CONSTANT int32_t kBindMockupBoundaryPlace = 14;   // uint32_t: slot · 512 + bit of a boundary voxel
PALPATE_CONSTANT int32_t kBindMockupMixedBrick = 15;   // uint32_t: brick number of a slot
PALPATE_CONSTANT int32_t kBindToolVertices = 16;       // ivec3, tool lattice frame
PALPATE_CONSTANT int32_t kBindToolTriangles = 17;      // uvec3
PALPATE_CONSTANT int32_t kBindToolInfo = 18;           // uint32_t: kInfo… bits
PALPATE_CONSTANT int32_t kBindToolNormals = 19;        // ivec3, Q30, tool lattice frame
PALPATE_CONSTANT int32_t kBindToolWeights = 20;        // uint32_t, Q30
PALPATE_CONSTANT int32_t kBindToolBrickSlot = 21;      // uint32_t; refined
PALPATE_CONSTANT int32_t kBindToolBricks = 22;         // Brick; refined
PALPATE_CONSTANT int32_t kBindFineBrickSlot = 23;      // the tool's fine partition (SceneConstants::fine) …
PALPATE_CONSTANT int32_t kBindFineBricks = 24;
PALPATE_CONSTANT int32_t kBindFineListBegin = 25;
PALPATE_CONSTANT int32_t kBindFineListTriangles = 26;
PALPATE_CONSTANT int32_t kBindFineExit = 27;           // uint32_t, by V_bnd voxel of it: the axis step (0 … 5: −x, +x, −y …) that leads out to V_ext
PALPATE_CONSTANT int32_t kBindToolNear = 30;           // a bit a voxel of the fine grid: a mock-up voxel with its centre there may meet the tool's solid
PALPATE_CONSTANT int32_t kBindFinePlaces = 31;         // uint32_t: kBindFineListTriangles as places in the order of clusters; of a closed tool (refined)

// The frame.
PALPATE_CONSTANT int32_t kBindFrameInput = 32;                   // FrameInput, one; mapped, written by the host
PALPATE_CONSTANT int32_t kBindFrameLists = 33;                   // FrameList[kListCount]
PALPATE_CONSTANT int32_t kBindFrameState = 34;                   // FrameState, one
PALPATE_CONSTANT int32_t kBindDispatches = 35;                   // DispatchArguments[kDispatchCount]: the response's, set by frame_sets.comp
PALPATE_CONSTANT int32_t kBindClusterBoxes = 37;                 // LatticeBox[clusters]: of the transformed triangles of a cluster, closed
PALPATE_CONSTANT int32_t kBindMobileState = 38;                  // uint32_t[tool triangles]: kMobile… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindNearTriangles = 39;                    // NearTriangle[FrameInput::near_triangles]; mapped
PALPATE_CONSTANT int32_t kBindToolRecords = 40;                  // ToolRecord[tool triangles], in the order of clusters
PALPATE_CONSTANT int32_t kBindTouchCandidates = 41;              // TouchCandidate[FrameInput::touch_candidates]; mapped
PALPATE_CONSTANT int32_t kBindVoxelState = 42;                   // uint32_t[boundary voxels]: kVoxel… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindTouchedVoxels = 43;                // kListTouchedVoxels: FrameVoxel, each V_bnd voxel touched by a mobile triangle once
PALPATE_CONSTANT int32_t kBindInsideSamples = 44;                // FrameSample[FrameInput::inside_samples]; mapped
PALPATE_CONSTANT int32_t kBindStaticChunks = 45;                 // kListStaticChunks: StaticChunk
PALPATE_CONSTANT int32_t kBindPairCandidates = 47;               // PairCandidate[FrameInput::pair_candidates]; mapped
PALPATE_CONSTANT int32_t kBindPairs = 48;                        // kListPairs: ContactPair, distinct intersecting pairs
PALPATE_CONSTANT int32_t kBindStaticState = 49;                  // uint32_t[static triangles]: kStatic… bits; 0 between frames
PALPATE_CONSTANT int32_t kBindStaticSlot = 50;                   // uint32_t[static triangles]: position in contact_statics; valid where the state is not 0
PALPATE_CONSTANT int32_t kBindContactStatics = 51;               // kListContactStatics: uint32_t static id = C_s
PALPATE_CONSTANT int32_t kBindContactMobiles = 52;               // kListContactMobiles: uint32_t tool triangle = C_m
PALPATE_CONSTANT int32_t kBindSampleChunks = 53;                 // kListSampleChunks: SampleChunk over voxels that may hold counting samples; mapped
PALPATE_CONSTANT int32_t kBindOpenSamples = 54;                  // kListOpenSamples: FrameSample in V_bnd voxels of the tool: the winding decides; mapped
PALPATE_CONSTANT int32_t kBindSamples = 55;                      // kListSamples: FrameSample that count (inside; or the rule for open tools); refined only
PALPATE_CONSTANT int32_t kBindHeldStatics = 56;                  // HeldStatic[FrameInput::held_statics]; mapped
PALPATE_CONSTANT int32_t kBindHeldAreas = 57;                    // HeldDirection[FrameInput::held_areas]; mapped
PALPATE_CONSTANT int32_t kBindResult = 58;                       // FrameResult, one; mapped, read by the host
PALPATE_CONSTANT int32_t kBindResultStatics = 59;                // StaticResult[C_s], by slot; mapped
PALPATE_CONSTANT int32_t kBindResultMobiles = 60;                // MobileResult[C_m], by position; mapped
PALPATE_CONSTANT int32_t kBindResultMembers = 61;                // kListMembers: AreaMember; mapped
PALPATE_CONSTANT int32_t kBindResultPierces = 62;                // kListPierces: AreaPierce; mapped
PALPATE_CONSTANT int32_t kBindToolCorners = 65;        // ToolCorners[tool triangles]: transformed, in the order of clusters
PALPATE_CONSTANT int32_t kBindRunBoxes = 66;           // LatticeBox[runs]: of kRunSize triangles that follow each other in a cluster
PALPATE_CONSTANT int32_t kBindToolBins = 67;           // ToolBin[bins]; refined
PALPATE_CONSTANT int32_t kBindBinEntries = 68;         // uint32_t: places in the order of clusters, bin by bin
PALPATE_CONSTANT int32_t kBindWideTriangles = 69;      // uint32_t: places of triangles that lie in too many bins
PALPATE_CONSTANT int32_t kBindBinState = 70;           // BinState, one
PALPATE_CONSTANT int32_t kBindRayLists = 63;                     // RayList[kListSamples]; mapped; where the host joined the areas
PALPATE_CONSTANT int32_t kBindRayPlaces = 64;                    // uint32_t: places of tool triangles, in the order of clusters; mapped
PALPATE_CONSTANT int32_t kBindResponseFirst = 72;                // frame_response.h has this one and above

// ---- lists ---------------------------------------------------------------------------------------------------------------

PALPATE_CONSTANT uint32_t kListNearTriangles = 0;                // filled by the host, which knows its length: FrameInput::near_triangles
PALPATE_CONSTANT uint32_t kListTouchCandidates = 2;              // by the host
PALPATE_CONSTANT uint32_t kListTouchedVoxels = 3;
PALPATE_CONSTANT uint32_t kListInsideSamples = 4;                // by the host
PALPATE_CONSTANT uint32_t kListStaticChunks = 5;
PALPATE_CONSTANT uint32_t kListPairCandidates = 6;               // by the host
PALPATE_CONSTANT uint32_t kListPairs = 7;
PALPATE_CONSTANT uint32_t kListContactStatics = 8;
PALPATE_CONSTANT uint32_t kListContactMobiles = 9;
PALPATE_CONSTANT uint32_t kListSampleChunks = 10;                // by the host; for tools without inside by the device
PALPATE_CONSTANT uint32_t kListOpenSamples = 11;                 // by the host where samples are listed, else by the device
PALPATE_CONSTANT uint32_t kListSamples = 12;
PALPATE_CONSTANT uint32_t kListMembers = 13;                     // response: mobile triangles of areas; ids only, goes to the host as it is
PALPATE_CONSTANT uint32_t kListPierces = 14;                     // response: distinct (area, pierced area); goes to the host as it is
PALPATE_CONSTANT uint32_t kListResponseFirst = 16;               // 16…31: lists of frame_response.h
PALPATE_CONSTANT uint32_t kListCount = 32;

// An overflow is a bit of FrameState::overflow: 1 << list for a list, and in overflow_other:
PALPATE_CONSTANT uint32_t kOverflowAreas = 1u << 1;              // more than kMaxFrameAreas
PALPATE_CONSTANT uint32_t kOverflowLoop = 1u << 2;               // an invocation would have run beyond kLoopBudget
PALPATE_CONSTANT uint32_t kOverflowBins = 1u << 3;               // the bins of the tool's shadow have too many entries
PALPATE_CONSTANT uint32_t kOverflowResponseFirst = 1u << 8;      // bits 8…31: frame_response.h
PALPATE_CONSTANT uint32_t kLoopBudget = 30000;                   // loop iterations of one invocation, all its loops together (llvmpipe ends loops silently at 65,535)

struct DispatchArguments {
  uint32_t x, y, z;
};

struct FrameList {
  uint32_t count;                 // items; while being filled it may run beyond `capacity`
  uint32_t asked;                 // items that were asked for, set at closing
  uint32_t capacity;              // items that fit; written once by the host
  DispatchArguments items;        // groups of kGroupSize invocations for one invocation an item; set at closing
  DispatchArguments groups;       // groups for one workgroup an item; set at closing
};

// Group counts for the response; all 0 in a frame that does not need them. `One` is a single workgroup.
PALPATE_CONSTANT uint32_t kDispatchContactOne = 0;               // contact
PALPATE_CONSTANT uint32_t kDispatchContactStatics = 1;           // contact: an invocation a slot of C_s
PALPATE_CONSTANT uint32_t kDispatchContactMobiles = 2;           // contact: an invocation a member of C_m
PALPATE_CONSTANT uint32_t kDispatchSamples = 4;                  // contact: an invocation a counting sample (refined)
PALPATE_CONSTANT uint32_t kDispatchPairs = 6;                    // contact: an invocation a pair
PALPATE_CONSTANT uint32_t kDispatchTouchedVoxels = 7;            // contact: an invocation a touched V_bnd voxel
PALPATE_CONSTANT uint32_t kDispatchHeldStatics = 9;              // contact: an invocation a HeldStatic
PALPATE_CONSTANT uint32_t kDispatchSwallowedOne = 10;            // swallowed: a single workgroup
PALPATE_CONSTANT uint32_t kDispatchSwallowed = 11;               // swallowed: a workgroup a NearTriangle
PALPATE_CONSTANT uint32_t kDispatchClusters = 5;                 // rays are needed: a workgroup a cluster of the tool
PALPATE_CONSTANT uint32_t kDispatchBins = 8;                     // samples may be inside: an invocation a bin
PALPATE_CONSTANT uint32_t kDispatchReset = 14;                   // contact: an invocation an entry of whatever is emptied at the frame's end
PALPATE_CONSTANT uint32_t kDispatchResetFree = 12;               // no contact: the same
PALPATE_CONSTANT uint32_t kDispatchBinTriangles = 15;  // some sample is open: an invocation a tool triangle
PALPATE_CONSTANT uint32_t kDispatchResponseFirst = 16;           // 16…31: of the response's own making
PALPATE_CONSTANT uint32_t kDispatchCount = 32;

// ---- what the host gives a frame -----------------------------------------------------------------------------------------

struct FrameInput {
  int32_t rotation_q30[9];        // row-major, world from tool (LatticePose)
  ivec3 translation;              // steps
  ivec3 brick_first;              // bricks of the mock-up's grid that the tool's box can meet …
  ivec3 brick_last;               // … inclusive; the host submits nothing when there are none
  ivec3 last_direction;           // Held::last_direction, 0: none
  uint32_t held_areas;            // entries of held areas, in the order of Held::areas
  ivec3 tool_low, tool_high;     // holds all transformed corners; closed
  int32_t bin_shift;             // bins are 2^bin_shift steps wide, from tool_low on
  uint32_t held_statics;          // entries of held statics
  uint32_t near_triangles;        // entries of the lists that the host filled …
  uint32_t touch_candidates;
  uint32_t pair_candidates;
  uint32_t sample_chunks;
  uint32_t inside_samples;
  uint32_t open_samples;
  uint32_t rays;                  // 1: the bodies may meet: the tool may be needed as a whole, where rays or samples ask for it
};

struct HeldStatic {
  uint32_t static_id;
  uint32_t held_area;             // position in held areas
};

struct HeldDirection {
  ivec3 direction;
  int32_t sheet_sign;
};

// ---- what it keeps -------------------------------------------------------------------------------------------------------

struct FrameState {
  uint32_t overflow;              // bit per list
  uint32_t overflow_other;        // kOverflow… bits
  uint32_t contact;               // 1: CST, IMT or EST is not empty
  uint32_t swallowed;             // 1: IMT, but no CST and no counting sample (refined)
  uint32_t cst, bst, est, cmt, bmt, imt; // sizes of the sets
};
// Samples are rounded by less than a step, transformed corners too. Bodies that keep this distance have no sample on the wrong side
// of each other's surface.
PALPATE_CONSTANT int32_t kCloseSteps = 3;

struct LatticeBox {
  ivec3 low, high;                // closed; low > high: empty
};

// A tool triangle at this pose. A void one has all its corners in one place: no ray crosses it.
struct ToolCorners {
  ivec3 a, b, c;
};

// Bins: a square grid over the tool's shadow along x, kept only while samples need rays along x. A bin lists the triangles whose
// boxes meet it.
struct ToolBin {
  uint32_t count, begin, filled;
};
struct BinState {
  uint32_t entries;              // places given out
  uint32_t wide;                 // triangles in the list of wide ones
};
PALPATE_CONSTANT uint32_t kWideTriangle = 32;                    // bins beyond which a triangle is wide (chosen)

// States of a static triangle. CST wins over BST when sets are named; EST may be in BST too.
PALPATE_CONSTANT uint32_t kStaticHit = 1u;                       // in an intersecting pair: CST
PALPATE_CONSTANT uint32_t kStaticListed = 2u;                    // listed in a touched V_bnd voxel: BST unless CST
PALPATE_CONSTANT uint32_t kStaticSampled = 4u;                   // a sample inside the tool: EST unless CST (refined)

// States of a tool triangle at this pose. CMT wins, then IMT, then BMT.
PALPATE_CONSTANT uint32_t kMobileHit = 1u;                       // in an intersecting pair: CMT
PALPATE_CONSTANT uint32_t kMobileInternal = 2u;                  // touches a V_int voxel: IMT unless CMT
PALPATE_CONSTANT uint32_t kMobileBoundary = 4u;                  // touches a V_bnd voxel: BMT in neither
PALPATE_CONSTANT uint32_t kMobileSets = 7u;                      // any of the first three: in C_m

PALPATE_CONSTANT uint32_t kVoxelTouched = 1u;                    // in touched voxels

// A tool triangle and a brick of the mock-up with voxels that it may touch, found by the host (compute/broad_phase.h).
struct NearTriangle {
  uint32_t place;                 // in the order of clusters; with kFirstOfTriangle in the first entry of each triangle
  uint32_t slot;                  // of the brick; kBrickInternal: all of it is V_int
  int32_t xy;                     // brick x + 2^16 · brick y
  int32_t z;
};
PALPATE_CONSTANT uint32_t kFirstOfTriangle = 1u << 31;

// A tool triangle as it was loaded, tool lattice frame.
struct ToolRecord {
  ivec3 a;
  uint32_t id;
  ivec3 b;
  uint32_t info;                  // kInfo… bits
  ivec3 c;
  uint32_t padding;
};

// A tool triangle that comes near a voxel that is V_bnd or V_int, found by the host (compute/near_pairs.h).
struct TouchCandidate {
  uint32_t place;                 // in the order of clusters
  uint32_t boundary;              // number of the V_bnd voxel; kNoVoxel: V_int
  int32_t xy;                     // voxel x + 2^16 · voxel y
  int32_t z;                      // with kWholeBrick: the voxel is the first one of a brick that is all V_int, and stands for it
};
PALPATE_CONSTANT int32_t kWholeBrick = 1 << 30;

// A V_bnd voxel of the mock-up's grid.
struct FrameVoxel {
  uint32_t boundary;              // its number among V_bnd voxels: state and list
  ivec3 voxel;                    // coordinates in the grid
};

// Parts [begin, end) of the list of static triangles of a V_bnd voxel, so that no invocation walks a long list.
struct StaticChunk {
  uint32_t begin, end;            // to be marked as listed in a touched voxel
};
struct SampleChunk {
  ivec3 voxel;                    // whose samples are asked for
  uint32_t begin, end;            // of its list
};
PALPATE_CONSTANT uint32_t kStaticChunk = 8;                      // entries in a StaticChunk (chosen: most lists are shorter)
PALPATE_CONSTANT uint32_t kSampleChunk = 2;                      // entries in a SampleChunk
PALPATE_CONSTANT uint32_t kMostChunks = 1024, kMostStaticChunks = 8192;   // chunks of one list: where it is very long, chunks are longer

// Two triangles whose boxes meet, found by the host.
struct PairCandidate {
  uint32_t static_id;
  uint32_t place;                 // of the tool triangle, in the order of clusters
};

struct ContactPair {
  uint32_t static_id;
  uint32_t mobile;
};

struct FrameSample {
  ivec3 point;                    // world lattice
  uint32_t static_id;             // its triangle; the weight is the triangle's. With kCornerProbe: the point is the triangle's first corner (which is
                                  // left out where it is known to lie inside), tells EST and does not count
};
PALPATE_CONSTANT uint32_t kCornerProbe = 1u << 31;               // more triangles than this do not fit a lattice mesh

// What a counting sample's ray may cross before it is out of the tool, found by the host (compute/near_rays.h).
struct RayList {
  uint32_t begin, end;            // of the ray places
  uint32_t stop;                  // crossings count below this height
};

// ---- what it leaves to the host ------------------------------------------------------------------------------------------

// ContactArea without its lists; equal names mean the same. Area numbers of a frame are in no particular order: the host
// sorts by id and renumbers.
struct AreaResult {
  uint32_t id;                    // smallest static id
  uint32_t flags;                 // ContactFlag bits of model/contacts.h
  ivec3 direction;
  int32_t sheet_sign;
  uint32_t rays;
  uint32_t max_height;
  int64_t height_sum;
  int64_t weight_sum;
  int64_t faded_sum;
  int64_t faded_rest;
  int64_t weight_slope;
  int64_t height_slope;
  int64_t moment_low[3];          // WideSum::low
  int64_t moment_high[3];         // WideSum::high
  int64_t voxel_sum[3];
  uint32_t voxel_count;
  uint32_t padding;
};

struct FrameResult {
  FrameState state;
  uint32_t flags;                 // ContactFlag bits of the frame itself (swallowed and its rule)
  uint32_t pair_count;
  uint32_t static_count;          // entries of the statics' results
  uint32_t mobile_count;          // entries of the mobiles' results
  uint32_t member_count;          // entries of the members
  uint32_t pierce_count;
  uint32_t area_count;            // ≤ kMaxFrameAreas
  ivec3 swallowed_direction;
  uint32_t swallowed_height;
  uint32_t sample_count;          // that count
  AreaResult areas[kMaxFrameAreas];
};

struct StaticResult {
  uint32_t id;
  uint32_t state;                 // kStatic… bits
  uint32_t area;                  // area number of this frame; kNone without contact (the response writes it)
  uint32_t zone;                  // equal for triangles of one zone, different between zones (the response writes it)
};

struct MobileResult {
  uint32_t id;
  uint32_t state;                 // kMobile… bits
};

struct AreaMember {
  uint32_t area;
  uint32_t mobile;
};

struct AreaPierce {
  uint32_t area;                  // has a ray that …
  uint32_t pierced;               // … leaves this area's surface before it leaves the tool
};

PALPATE_ASSERT_SIZE(FrameList, 36);
PALPATE_ASSERT_SIZE(FrameInput, 148);
PALPATE_ASSERT_SIZE(NearTriangle, 16);
PALPATE_ASSERT_SIZE(ToolRecord, 48);
PALPATE_ASSERT_SIZE(TouchCandidate, 16);
PALPATE_ASSERT_SIZE(AreaResult, 160);
PALPATE_ASSERT_SIZE(FrameResult, 88 + 160 * kMaxFrameAreas);

PALPATE_SHARED_END
#endif
