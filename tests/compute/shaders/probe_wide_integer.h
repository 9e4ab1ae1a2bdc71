// Both sides of probe_wide_integer.comp.
#ifndef PALPATE_PROBE_WIDE_INTEGER_H
#define PALPATE_PROBE_WIDE_INTEGER_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct WideCase {
  int64_t n[3];
  int64_t x, y;
  ivec3 d;
  ivec3 a, b, c;
};
PALPATE_ASSERT_SIZE(WideCase, 88);

struct WideAnswer {
  int64_t dot_high;
  uint64_t dot_low;
  int64_t product_high;
  uint64_t product_low;
  int64_t sum_high;
  uint64_t sum_low;
  int64_t difference_high;
  uint64_t difference_low;
  int64_t normal[3];
  uint64_t ratio;
  uint64_t ratio_two;
  int32_t sign_;
  int32_t wide_sign;
  int32_t less;
  int32_t unused;
};
PALPATE_ASSERT_SIZE(WideAnswer, 120);
PALPATE_SHARED_END
#endif
