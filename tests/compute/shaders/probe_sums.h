// Both sides of the probe of lib/direction.glsl.
#ifndef PALPATE_PROBE_SUMS_H
#define PALPATE_PROBE_SUMS_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct DirectionCase {
  int64_t sum[3];
};
PALPATE_ASSERT_SIZE(DirectionCase, 24);
PALPATE_SHARED_END
#endif
