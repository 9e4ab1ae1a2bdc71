// What the response half of a frame keeps and leaves in profile `refined`: the pressure field.
// docs/EXACTNESS.md section 8.
//
// Sums are of 64-bit words that many workgroups add to, in any order: FieldWork and CarrierWork are arrays of
// words to the shaders, by the numbers below, and structs to the host. A batch has a FieldWork a pose.
#ifndef PALPATE_SHARED_FRAME_FIELD_H
#define PALPATE_SHARED_FRAME_FIELD_H
#include "shaders/shared/base.h"
#include "shaders/shared/frame.h"

PALPATE_SHARED_BEGIN

// ---- bindings and lists
// --------------------------------------------------------------------------------------------------

PALPATE_CONSTANT int32_t kBindFieldWork = 96;      // int64_t[kFieldWords]: FieldWork
PALPATE_CONSTANT int32_t kBindCarrierWork = 97;    // int64_t[kCarrierWords · C_s], by slot: CarrierWork
PALPATE_CONSTANT int32_t kBindFieldTiles = 98;     // kListFieldTiles: FieldTile
PALPATE_CONSTANT int32_t kBindMockupPoints = 99;   // kListMockupPoints: FieldPoint, samples inside the tool
                                                   // that weigh something, and extra ones of C_s
PALPATE_CONSTANT int32_t kBindToolPoints = 100;    // kListToolPoints: FieldPoint, samples of C_m in V_bnd or
                                                   // V_int voxels of the mock-up, and its extra ones
PALPATE_CONSTANT int32_t kBindIgnored = 101;       // a bit a patch; mapped
PALPATE_CONSTANT int32_t kBindIgnoredState = 102;  // a bit a patch: it is in the list; 0 between frames
PALPATE_CONSTANT int32_t kBindResultIgnored =
    103;  // kListIgnored: uint32_t patches in which something would push; mapped
PALPATE_CONSTANT int32_t kBindResultField = 104;     // FieldWork, one; mapped, read by the host
PALPATE_CONSTANT int32_t kBindResultCarriers = 105;  // CarrierWork[C_s], by slot; mapped
PALPATE_CONSTANT int32_t kBindMockupLevels =
    106;  // a uint32_t a triangle: 1 + place of its side's levels, or 0; then kSideLevelWords a place: the
          // coarsest level, factors (Q30)
PALPATE_CONSTANT int32_t kBindToolLevels = 107;  // likewise
PALPATE_CONSTANT int32_t kBindMockupShells =
    108;  // int32_t, by V_bnd voxel: how many shells its middle is in; then two words a voxel: which
          // neighbours say less of it, and of which it says less (shell_doubt.comp); of a mock-up that is not
          // closed
PALPATE_CONSTANT int32_t kBindFineShells =
    109;  // likewise of the tool's fine partition, where it has an inside

PALPATE_CONSTANT int32_t kBindMockupTree = 110;  // texels: kTreeHeadTexels of shared/scene.h and what follows
PALPATE_CONSTANT int32_t kBindToolTree = 111;    // likewise, tool lattice frame

PALPATE_CONSTANT int32_t kBindToolSamplePoints =
    120;  // texels: the tool's grid samples, by triangle, those of the highest level first: point, level
PALPATE_CONSTANT int32_t kBindToolSampleEnds =
    121;  // texels, kSampleEndTexels a triangle: with which sample it begins, how many it has, and of these
          // how many are of at least level 1, 2, …

PALPATE_CONSTANT uint32_t kMostSampleLevel = 6u;   // kSampleLevels of model/lattice/lattice_mesh.h
PALPATE_CONSTANT uint32_t kMostSurfaceLevel = 4u;  // kSurfaceLevels
PALPATE_CONSTANT uint32_t kSideLevelWords = 1u + kMostSampleLevel;
PALPATE_CONSTANT uint32_t kSampleEndTexels = 2u;  // 1 + 1 + kMostSampleLevel words

PALPATE_CONSTANT uint32_t kListFieldTiles = 16u;
PALPATE_CONSTANT uint32_t kListMockupPoints = 17u;
PALPATE_CONSTANT uint32_t kListToolPoints = 18u;

PALPATE_CONSTANT uint32_t kMostTiles = 256u;     // of a triangle (chosen): where it is large, tiles are
PALPATE_CONSTANT uint32_t kFieldTileLanes = 8u;  // invocations that go through it (chosen: most triangles
                                                 // have no more cells, and llvmpipe takes eight at once)
PALPATE_CONSTANT uint32_t kExtraTile = 16u;      // most extra samples of a tile
PALPATE_CONSTANT uint32_t kLeastWay = 64u;       // steps from which on a way out has a direction (section 4)
PALPATE_CONSTANT int32_t kDepthSlack = 16;       // steps by which a distance may be off, and more (section 4)

// ---- structs
// -------------------------------------------------------------------------------------------------------------

// ExtraSample of model/lattice/lattice_mesh.h.
struct ExtraSample {
  uint32_t triangle;
  ivec3 point;
  uint32_t weights[kMostSurfaceLevel + 1u];  // by level, Q30, of 2^level s²
};

// A sample that pushes if it lies inside the other body.
struct FieldPoint {
  ivec3 point;        // world lattice
  uint32_t triangle;  // its own; of a batch: entry of the tables. With kExtraPoint: an extra one of the
                      // mock-up, of which nobody knows yet whether it lies inside the tool
  uint32_t weight;    // Q24
};

PALPATE_CONSTANT uint32_t kExtraPoint = 1u << 31;  // more triangles than this do not fit a lattice mesh

// Cells begin … end − 1 of a tool triangle's box, which is `across` cells wide and begins at cell (first_u,
// first_v), row by row. Or, where `across` is 0, samples begin … end − 1, and first_u says which.
PALPATE_CONSTANT int32_t kTileToolExtras = 0;    // extra ones of the tool
PALPATE_CONSTANT int32_t kTileMockupExtras = 1;  // of the mock-up
PALPATE_CONSTANT int32_t kTileToolSamples = 2;   // listed ones of the tool's grid
struct FieldTile {
  uint32_t triangle;  // of a batch: entry of the tables
  int32_t first_u, first_v;
  uint32_t across;
  uint32_t begin, end;
};

// FieldBin of model/contact/field.h; low and high are those of WideSum.
struct FieldBinWork {
  int64_t samples;
  int64_t push_low[3];
  int64_t push_high[3];
  int64_t turn_low[3];
  int64_t turn_high[3];
  int64_t give;
  int64_t give_at[3];
  int64_t give_spread[6];
};
PALPATE_CONSTANT uint32_t kFieldBinCount = 27u;
PALPATE_CONSTANT uint32_t kFieldBinWords = 23u;
PALPATE_ASSERT_SIZE(FieldBinWork, 8 * kFieldBinWords);

struct FieldWork {
  FieldBinWork bins[kFieldBinCount];
  int64_t deepest_static;  // the largest φ · 2^32 + (2^32 − 1 − static id); 0: nothing pushes
  int64_t deepest_mobile;  // likewise of the mobile ids
  int64_t sheet;           // not 0: a sheet's sample pushed, or one of a body without inside
};
PALPATE_CONSTANT uint32_t kWordDeepest = kFieldBinCount * kFieldBinWords;  // static, then mobile
PALPATE_CONSTANT uint32_t kWordSheet = kWordDeepest + 2u;
PALPATE_CONSTANT uint32_t kFieldWords = kWordSheet + 1u;
PALPATE_ASSERT_SIZE(FieldWork, 8 * kFieldWords);

// CarrierSums of model/contact/field.h.
struct CarrierWork {
  int64_t samples;
  int64_t weight_sum;
  int64_t depth_sum;
  int64_t push_low[3];
  int64_t push_high[3];
  int64_t moment_low[3];
  int64_t moment_high[3];
  int64_t max_depth;
};
PALPATE_CONSTANT uint32_t kCarrierSumWords = 15u;  // all but the last, which is no sum
PALPATE_CONSTANT uint32_t kWordCarrierDepth = kCarrierSumWords;
PALPATE_CONSTANT uint32_t kCarrierWords = 16u;
PALPATE_ASSERT_SIZE(CarrierWork, 8 * kCarrierWords);

PALPATE_ASSERT_SIZE(ExtraSample, 36);
PALPATE_ASSERT_SIZE(FieldPoint, 20);

PALPATE_SHARED_END
#endif
