// Both sides of probe_wide_integer.comp.
#ifndef PALPATE_PROBE_WIDE_INTEGER_H
#define PALPATE_PROBE_WIDE_INTEGER_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN
struct WideCase {
  int64_t n[3];
  ivec3 d, e;
  ivec3 a, b, c;
  int32_t unused;
};
PALPATE_ASSERT_SIZE(WideCase, 88);

struct WideAnswer {
  int64_t dot_high, dot_low;  // Split30
  int64_t sum_high, sum_low;
  int64_t difference_high, difference_low;
  int64_t normal[3];
  int32_t sign_;
  int32_t negated_sign;
  int32_t is_zero;
  int32_t number_sign;
};
PALPATE_ASSERT_SIZE(WideAnswer, 88);
PALPATE_SHARED_END
#endif
