// The prepared scene as every shader sees it. docs/EXACTNESS.md section 2 says what it means.
#ifndef PALPATE_SHARED_SCENE_H
#define PALPATE_SHARED_SCENE_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN

// Codes in brick_slot[]; any smaller value is the place of a mixed brick in bricks[].
PALPATE_CONSTANT uint32_t kBrickExternal = 0xFFFFFFFFu;
PALPATE_CONSTANT uint32_t kBrickInternal = 0xFFFFFFFEu;

// Classes of a voxel, as VoxelClass of model/lattice/voxel_grid.h.
PALPATE_CONSTANT uint32_t kVoxelExternal = 0u;
PALPATE_CONSTANT uint32_t kVoxelBoundary = 1u;
PALPATE_CONSTANT uint32_t kVoxelInternal = 2u;

// triangle_info[]: bits 0–7 are TriangleFlag of model/lattice/lattice_mesh.h, bits 8–9 the sample axis; bit
// 10: it has extra samples.
PALPATE_CONSTANT uint32_t kInfoCollapsed = 1u;
PALPATE_CONSTANT uint32_t kInfoSheet = 2u;
PALPATE_CONSTANT uint32_t kInfoThin = 8u;
PALPATE_CONSTANT uint32_t kInfoAxisShift = 8u;
PALPATE_CONSTANT uint32_t kInfoHasExtra = 1u << 10;

// Not a boundary voxel (boundary_index() of lib/partition.glsl).
PALPATE_CONSTANT uint32_t kNoVoxel = 0xFFFFFFFFu;

// Steps by which a tool's voxel grows before it is asked what it touches.
PALPATE_CONSTANT int32_t kToolVoxelGrowth = 3;

// A grid of voxels: VoxelGrid of model/lattice/voxel_grid.h, and how much of it is detailed.
struct GridConstants {
  ivec3 origin;              // lattice steps
  int32_t size;              // lattice steps
  ivec3 bricks;              // along each axis; brick (x,y,z) is number x + bricks.x·(y + bricks.y·z)
  uint32_t mixed_bricks;     // entries of bricks[]
  uint32_t boundary_voxels;  // entries of list_begin[] − 1
  uint32_t list_entries;     // entries of list_triangles[]
};
PALPATE_ASSERT_SIZE(GridConstants, 40);

// A brick of 8³ voxels that is not all of one class but boundary. Voxel (x,y,z) in it is bit x + 8y + 64z:
// word bit >> 5, bit & 31.
struct Brick {
  uint32_t boundary[16];   // set: V_bnd
  uint32_t internal_[16];  // set: V_int; never both
  uint32_t first[16];      // compact index of the word's first boundary voxel
};
PALPATE_ASSERT_SIZE(Brick, 192);
PALPATE_CONSTANT uint32_t kBrickWords = 48u;         // the same, word by word
PALPATE_CONSTANT uint32_t kBrickInternalWord = 16u;  // of internal_[0]
PALPATE_CONSTANT uint32_t kBrickFirstWord = 32u;     // of first[0]
PALPATE_ASSERT_OFFSET(Brick, internal_, 64);
PALPATE_ASSERT_OFFSET(Brick, first, 128);

// A body's tree as shaders read it, in texels of four words: a head (how many triangles, how many levels,
// with which texel their order and their records begin); by level one (with which its groups of eight boxes
// begin, how many boxes it has); TriangleTree::Boxes of compute/scene/triangle_tree.h level by level;
// TriangleTree::order, four a texel; by place in that order a triangle's corners and unit normal, a texel a
// corner with a component of the normal behind it.
PALPATE_CONSTANT uint32_t kMostTreeLevels = 11u;  // 8^11 triangles are more than a mesh can have
PALPATE_CONSTANT uint32_t kTreeLevel = 1u;        // the first level's texel
PALPATE_CONSTANT uint32_t kTreeHeadTexels = kTreeLevel + kMostTreeLevels;
PALPATE_CONSTANT uint32_t kTreeGroupTexels = 12u;  // of eight boxes: lows by axis, then highs
PALPATE_CONSTANT uint32_t kTreeRecordTexels = 3u;

// A body: mock-up (world lattice frame) or tool (tool lattice frame).
struct BodyConstants {
  uint32_t vertices;
  uint32_t triangles;
  uint32_t closed;     // 1: every edge's signed incidence is 0
  GridConstants grid;  // all 0 when there is no partition (the tool's in `paper`)
};
PALPATE_ASSERT_SIZE(BodyConstants, 52);

// Binding `scene` of every shader of a frame.
struct SceneConstants {
  BodyConstants mockup;
  BodyConstants tool;
  int32_t tool_radius;         // steps
  int32_t lever_shift;         // of it (model/contact/field.h)
  int32_t sample_spacing;      // steps, of both bodies
  uint32_t refined;            // 1: profile `refined`, 0: `paper`
  uint32_t mockup_has_inside;  // 1: a point can lie in it (docs/EXACTNESS.md section 4); refined
  uint32_t tool_has_inside;    // likewise
  uint32_t mockup_extras;      // extra samples; refined
  uint32_t tool_extras;
  uint32_t contact_samples;  // of a body, that say what a contact pushes with; 0: all
  GridConstants fine;  // a second, finer partition of a closed tool, or its own: early answers for samples
};
PALPATE_ASSERT_SIZE(SceneConstants, 180);
PALPATE_ASSERT_OFFSET(SceneConstants, tool_radius, 104);

PALPATE_SHARED_END
#endif
