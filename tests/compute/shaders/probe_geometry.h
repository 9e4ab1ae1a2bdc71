// Both sides of the probes of lib/triangle_pair.glsl, lib/ray.glsl and lib/sample.glsl.
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
  int32_t crossing_sign;     // of ray_crossing along the direction
  uint32_t height;
  int32_t x_sign;            // of x_crossing
};
PALPATE_ASSERT_SIZE(RayAnswer, 12);

struct SampleCase {
  ivec3 corner[3];
  int32_t axis;
  int32_t u, v;              // grid point, in lattice steps
};
PALPATE_ASSERT_SIZE(SampleCase, 48);

struct SampleAnswer {
  int32_t inside;
  ivec3 point;
};
PALPATE_ASSERT_SIZE(SampleAnswer, 16);
PALPATE_SHARED_END
#endif
