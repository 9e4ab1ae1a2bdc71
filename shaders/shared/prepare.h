// Bounds and push constants of preparation, for its shaders and compute/.
#ifndef PALPATE_SHARED_PREPARE_H
#define PALPATE_SHARED_PREPARE_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN

// Bounds on what one invocation does, so that it stays far below the 32,000 loop iterations that lavapipe
// runs.
PALPATE_CONSTANT uint32_t kScanChunk = 64u;  // numbers that one invocation of a prefix sum adds
PALPATE_CONSTANT uint32_t kSmallCells =
    64u;  // bricks in the box of a triangle that is tested against them at once
PALPATE_CONSTANT int32_t kTopCells = 8;       // cells along an axis at the coarsest level
PALPATE_CONSTANT uint32_t kRankSpan = 256u;   // entries of a list among which one invocation ranks one
PALPATE_CONSTANT uint32_t kFindSteps = 256u;  // steps towards a root, before a union is left to the next run
PALPATE_CONSTANT uint32_t kUnionTries = 16u;  // lost races of a union, before it is left to the next run
PALPATE_CONSTANT int32_t kMostBricksAlong =
    3500;  // bricks along an axis: a row is swept by one invocation, 9 steps a brick
PALPATE_CONSTANT uint32_t kMostMixedBricks = 1u << 23;  // slot · 512 + bit fits 32 bits

// What triangle_expand.comp starts from.
PALPATE_CONSTANT uint32_t kSourceSmall = 0u;  // all triangles whose box holds at most kSmallCells bricks
PALPATE_CONSTANT uint32_t kSourceLarge = 1u;  // all others
PALPATE_CONSTANT uint32_t kSourceItems = 2u;  // items of the level above

struct ExpandPush {
  ivec3 origin;    // of the grid
  int32_t side;    // of a child cell, steps
  ivec3 cells;     // child cells along each axis
  int32_t growth;  // steps by which a cell grows before it is asked what it touches
  ivec3 parents;   // parent cells along each axis (items only)
  uint32_t count;  // triangles or items
  ivec3 bricks;    // along each axis
  int32_t brick_side;
  uint32_t source;  // kSource…
  uint32_t emit;    // 0: count, 1: write
};
PALPATE_ASSERT_SIZE(ExpandPush, 72);

struct VoxelPush {
  ivec3 origin;
  int32_t size;  // of a voxel
  ivec3 bricks;
  int32_t growth;
  uint32_t count;     // items
  uint32_t out_base;  // first pair of this list
  uint32_t emit;      // 0: mark and count, 1: write
};
PALPATE_ASSERT_SIZE(VoxelPush, 44);

struct GridPush {
  ivec3 origin;
  int32_t size;  // of a voxel
  ivec3 bricks;
  uint32_t count;  // items
  uint32_t axis;   // or number of axes
};
PALPATE_ASSERT_SIZE(GridPush, 36);

struct EnclosedPush {
  uint32_t count;   // mixed bricks
  uint32_t bricks;  // all
};
PALPATE_ASSERT_SIZE(EnclosedPush, 8);

// Push constants of sample_list.comp.
struct SampleListPush {
  ivec3 origin;
  int32_t size;
  ivec3 bricks;
  int32_t spacing;
  uint32_t count;  // entries of this run
  uint32_t first;  // entry
  uint32_t base;   // number of its first sample
  uint32_t wide;   // as VoxelSamples::wide
};
PALPATE_ASSERT_SIZE(SampleListPush, 48);

// Cells begin … end − 1, row by row, of a tool triangle's box, which is `across` cells wide and begins at
// cell (first_u, first_v).
struct ToolSampleTile {
  uint32_t triangle;
  int32_t first_u, first_v;
  uint32_t across, begin, end;
};
PALPATE_ASSERT_SIZE(ToolSampleTile, 24);

// Push constants of tool_sample_list.comp.
struct ToolSamplePush {
  uint32_t count;  // tiles
  int32_t spacing;
};
PALPATE_ASSERT_SIZE(ToolSamplePush, 8);

// begins[] after the samples were written (compute/scene/samples.h).
PALPATE_CONSTANT uint32_t kSampleCorner = 1u << 29;
PALPATE_CONSTANT uint32_t kSampleAxisShift = 30u;

PALPATE_SHARED_END
#endif
