// What the response half of a frame keeps: areas, directions, heights, sums. docs/EXACTNESS.md sections 5 to 7; the results
// that go to the host are in frame.h.
//
// Area numbers run from 0 to ResponseState::areas − 1 in no particular order; the host sorts by id. A slot is a position in C_s.
#ifndef PALPATE_SHARED_FRAME_RESPONSE_H
#define PALPATE_SHARED_FRAME_RESPONSE_H
#include "shaders/shared/base.h"
#include "shaders/shared/frame.h"

PALPATE_SHARED_BEGIN

// ---- bindings ------------------------------------------------------------------------------------------------------------

PALPATE_CONSTANT int32_t kBindResponseState = 72;     // ResponseState, one
PALPATE_CONSTANT int32_t kBindAreas = 73;             // AreaWork[kMaxFrameAreas]
PALPATE_CONSTANT int32_t kBindSlots = 74;             // SlotWork[C_s]
PALPATE_CONSTANT int32_t kBindMobileWork = 75;        // MobileWork[tool triangles]; valid for C_m
PALPATE_CONSTANT int32_t kBindHeldOverlap = 76;       // uint32_t[kMaxFrameAreas · held areas]: common static ids; 0 between frames
PALPATE_CONSTANT int32_t kBindMobileTiles = 77;       // kListMobileTiles: MobileTile
PALPATE_CONSTANT int32_t kBindHeights = 78;           // uint32_t[samples] (`paper`: [C_s]): H, or kNone
PALPATE_CONSTANT int32_t kBindSlotBoxes = 79;         // LatticeBox[C_s / kSlotBox]
PALPATE_CONSTANT int32_t kBindNeedleTable = 80;       // uint32_t[2^n]: hash of (area, tool vertex) + 1; 0 between frames
PALPATE_CONSTANT int32_t kBindNeedleVertices = 81;    // kListNeedleVertices: NeedleVertex
PALPATE_CONSTANT int32_t kBindParents = 82;           // uint32_t[2 · C_s], without zones [C_s]: union-find, lib/union_find.glsl
PALPATE_CONSTANT int32_t kBindFades = 83;             // uint32_t[samples]: H_0 (not in `paper`)

// ---- lists, dispatches, overflows ----------------------------------------------------------------------------------------

PALPATE_CONSTANT uint32_t kListMobileTiles = 16u;
PALPATE_CONSTANT uint32_t kListNeedleVertices = 17u;

PALPATE_CONSTANT uint32_t kDispatchNearest = 16u;         // a workgroup kGroupSize bricks (x, y) and request (z)
PALPATE_CONSTANT uint32_t kDispatchNearestOne = 17u;      // somebody asked for the nearest V_ext voxel
PALPATE_CONSTANT uint32_t kDispatchHeightRuns = 18u;      // an invocation a run of kHeightRun samples
PALPATE_CONSTANT uint32_t kDispatchPierceBoxes = 19u;     // several areas: an invocation a slot box
PALPATE_CONSTANT uint32_t kDispatchPierce = 20u;          // several areas: an invocation a counting sample
PALPATE_CONSTANT uint32_t kDispatchNeedlePairs = 21u;     // some area is a needle: an invocation a pair
PALPATE_CONSTANT uint32_t kDispatchMembers = 22u;         // some area needs mobile normals: an invocation a member

PALPATE_CONSTANT uint32_t kOverflowNeedleTable = 1u << 8;   // no free slot near a needle vertex's own in the table

PALPATE_CONSTANT uint32_t kSlotBox = 32u;              // slots that share a box (chosen: 1 box test for 32 triangle tests)
PALPATE_CONSTANT uint32_t kHeightRun = 32u;            // samples summed by one invocation before it touches an area's atomics
PALPATE_CONSTANT uint32_t kLeastFade = 8u;             // with a smaller H_0 a sample has its whole weight at once
PALPATE_CONSTANT uint32_t kNeedleProbes = 64u;         // entries looked at before the table counts as full
PALPATE_CONSTANT int32_t kMobileTile = 8;              // grid points along an edge of a tile of tool samples: one workgroup

// ---- structs -------------------------------------------------------------------------------------------------------------

// Who wants the nearest V_ext voxel of a point: an area, or the swallowed tool.
struct NearestRequest {
  uint64_t distance;         // smallest |2·centre − 2p|²; ~0: nothing found yet
  uint64_t voxel;            // smallest linear number at that distance
  ivec3 point;               // p, world lattice
  uint32_t area;             // its number; kNone: the swallowed tool
};

struct ResponseState {
  uint32_t areas;            // given out; beyond kMaxFrameAreas the frame is truncated
  uint32_t requests;         // of the nearest V_ext voxel
  uint32_t swallowed_flags;  // ContactFlag bits of the frame
  uint32_t swallowed_steps;  // largest k
  ivec3 swallowed_direction; // D
  uint32_t padding;          // whole 8 bytes
  NearestRequest request[kMaxFrameAreas];
};

// One slot of C_s.
struct SlotWork {
  uint32_t area;             // area number, kNone beyond the capacity
  uint32_t samples;          // counting samples of this triangle
};

// One tool triangle of C_m.
struct MobileWork {
  uint32_t claimed;          // 1: its tiles are in the list
  uint32_t samples;          // of its samples, those at this pose in a V_bnd or V_int voxel
  uint32_t nearest;          // the area that has it although no sphere holds it; kNone: the areas whose spheres hold it have it
};

// kMobileTile² points of a tool triangle's sample grid, beginning at grid point (first_u, first_v)·spacing.
struct MobileTile {
  uint32_t mobile;
  int32_t first_u, first_v;
};

struct NeedleVertex {
  uint32_t area;
  uint32_t vertex;           // of the tool
  uint32_t entry;            // in the needle table, to be emptied
};

// Bits of AreaWork::state.
PALPATE_CONSTANT uint32_t kAreaWantsMobile = 1u;    // mobile normals are needed
PALPATE_CONSTANT uint32_t kAreaProximity = 2u;      // no CST and no counting sample
PALPATE_CONSTANT uint32_t kAreaNeedle = 4u;

// One area. Sums are of whole frames' terms, in any order.
struct AreaWork {
  int64_t fixed_sum[3];        // Σ k·((w·n̂) >> 30), k counting samples, of triangles that are no sheet; `paper`: Σ n̂ over C_s
  int64_t sheet_sum[3];        // the same of sheet triangles, to be taken with the sheet sign
  int64_t static_weight;       // Σ k·w of both
  int64_t bare_fixed[3];       // Σ n̂ over CST that are no sheet
  int64_t bare_sheet[3];       // Σ n̂ over CST of sheets
  int64_t sheet_side[3];       // B: Σ n̂ over all C_s sheet triangles
  int64_t mobile_sum[3];       // Σ k·((w·n̂') >> 30); n_c takes it with a minus. `paper`: Σ n̂'
  int64_t mobile_weight;       // Σ k·w
  int64_t height_sum;          // of samples with a height …
  int64_t weight_sum;
  int64_t faded_sum;
  int64_t faded_rest;
  int64_t weight_slope;
  int64_t height_slope;
  int64_t moment_low[3];
  int64_t moment_high[3];
  int64_t voxel_sum[3];        // `paper`
  ivec3 box_low, box_high;     // of the corners of its triangles
  ivec3 direction;             // D
  uint32_t id;                 // smallest static id
  uint32_t zones;
  uint32_t statics;            // triangles
  uint32_t cst;                // of them in an intersecting pair
  uint32_t sheets;             // of them of a sheet
  uint32_t samples;            // counting
  uint32_t held_area;          // position in held areas, kNone
  int32_t sheet_sign;
  uint32_t flags;              // ContactFlag bits
  uint32_t state;
  uint32_t rays;
  uint32_t max_height;
  uint32_t voxel_count;        // `paper`
  uint32_t pierces[kMaxFrameAreas / 32u];   // bit per area number
  uint32_t padding;            // whole 8 bytes
};

// ContactFlag of model/contacts.h.
PALPATE_CONSTANT uint32_t kAreaFlagCancelled = 1u << 0;
PALPATE_CONSTANT uint32_t kAreaFlagSheet = 1u << 1;
PALPATE_CONSTANT uint32_t kAreaFlagToolOpen = 1u << 2;
PALPATE_CONSTANT uint32_t kAreaFlagNoDirection = 1u << 3;
PALPATE_CONSTANT uint32_t kAreaFlagNeedle = 1u << 8;
PALPATE_CONSTANT uint32_t kAreaFlagSwallowed = 1u << 9;
PALPATE_CONSTANT uint32_t kAreaFlagHeld = 1u << 12;
PALPATE_CONSTANT uint32_t kAreaFlagNearestExternal = 1u << 13;

PALPATE_SHARED_END
#endif
