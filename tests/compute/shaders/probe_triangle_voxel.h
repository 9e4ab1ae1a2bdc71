// Both sides of probe_triangle_voxel.comp.
#ifndef PALPATE_PROBE_TRIANGLE_VOXEL_H
#define PALPATE_PROBE_TRIANGLE_VOXEL_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct BoxCase {
  ivec3 a, b, c;
  ivec3 lo, hi;
};
PALPATE_ASSERT_SIZE(BoxCase, 60);
PALPATE_SHARED_END
#endif
