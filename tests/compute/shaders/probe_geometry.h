// Both sides of the probes of lib/triangle_pair.glsl, lib/ray.glsl, lib/segment.glsl,
// lib/segment_estimate.glsl, lib/distance.glsl, lib/distance_estimate.glsl, lib/sample.glsl, lib/cells.glsl
// and lib/voxel_range.glsl.
#ifndef PALPATE_PROBE_GEOMETRY_H
#define PALPATE_PROBE_GEOMETRY_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct PairCase {
  ivec3 s[3];
  ivec3 t[3];
};
PALPATE_ASSERT_SIZE(PairCase, 72);

struct RayCase {
  ivec3 point, direction;
  ivec3 corner[3];
};
PALPATE_ASSERT_SIZE(RayCase, 60);

struct RayAnswer {
  int32_t crossing_sign;  // of ray_crossing along the direction
  uint32_t height;
  int32_t culled;  // 1: it crosses what lib/line_box.glsl leaves out
};
PALPATE_ASSERT_SIZE(RayAnswer, 12);

struct SegmentAnswer {
  int32_t crossing;  // of segment_crossing
  int32_t estimate;  // of segment_estimate; 2: unsure
};
PALPATE_ASSERT_SIZE(SegmentAnswer, 8);

struct DistanceAnswer {
  int32_t steps;
  int32_t least, most;  // of distance_bounds, rounded outwards
};
PALPATE_ASSERT_SIZE(DistanceAnswer, 12);

struct DistanceCase {
  ivec3 point;
  ivec3 corner[3];
  ivec3 normal;  // Q30
};
PALPATE_ASSERT_SIZE(DistanceCase, 60);

struct SampleCase {
  ivec3 corner[3];
  int32_t axis;
  int32_t u, v;  // grid point, in lattice steps
};
PALPATE_ASSERT_SIZE(SampleCase, 48);

struct SampleAnswer {
  int32_t inside;
  ivec3 point;
};
PALPATE_ASSERT_SIZE(SampleAnswer, 16);

struct CellCase {
  ivec3 d;  // from the grid's origin
  ivec3 n;  // cells
  int32_t side;
  int32_t unused;
};
PALPATE_ASSERT_SIZE(CellCase, 32);

struct CellAnswer {
  ivec3 along;        // of cell_along
  ivec3 first, last;  // of first_touched, last_touched by the point
  ivec3 back;         // of the number of the cell that `along` is clamped to
};
PALPATE_ASSERT_SIZE(CellAnswer, 48);
PALPATE_SHARED_END
#endif
