// Both sides of the probes of lib/direction.glsl and lib/height_sum.glsl.
#ifndef PALPATE_PROBE_SUMS_H
#define PALPATE_PROBE_SUMS_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct DirectionCase {
  int64_t sum[3];
  int64_t weight;
};
PALPATE_ASSERT_SIZE(DirectionCase, 32);

struct DirectionAnswer {
  int32_t usable_;
  ivec3 direction;           // of a sum that is not 0
};
PALPATE_ASSERT_SIZE(DirectionAnswer, 16);

struct HeightCase {
  ivec3 point;
  uint32_t height, weight, fade;
};
PALPATE_ASSERT_SIZE(HeightCase, 24);

struct HeightAnswer {
  uint32_t rays, max_height;
  int64_t height, weight, faded, rest, weight_slope, height_slope;
  int64_t moment_low[3], moment_high[3];
};
PALPATE_ASSERT_SIZE(HeightAnswer, 104);
PALPATE_SHARED_END
#endif
