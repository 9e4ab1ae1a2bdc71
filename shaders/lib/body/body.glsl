// A body that does not move, in its own lattice frame, as its partition has it. The including shader names
// it: BODY_GRID (GridConstants) and
//   TRIPLES body_vertices, body_triangles; WORDS body_info, body_brick_slot, body_bricks, body_list_begin,
//   body_list.
#ifndef PALPATE_LIB_BODY
#define PALPATE_LIB_BODY
#include "shaders/lib/voxel_range.glsl"

#define PARTITION_GRID BODY_GRID
#define PARTITION_SLOTS body_brick_slot
#define PARTITION_BRICKS body_bricks
#define PARTITION(name) body_##name
#include "shaders/lib/partition.glsl"

// Neither collapsed nor of a sheet.
bool body_bounds_solid(uint32_t id) { return (body_info(id) & (kInfoCollapsed | kInfoSheet)) == 0u; }
#endif
