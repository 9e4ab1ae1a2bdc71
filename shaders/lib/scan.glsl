// Sums that stay at 2^32 − 1 instead of wrapping.
#ifndef PALPATE_LIB_SCAN
#define PALPATE_LIB_SCAN
#include "shaders/shared/prepare.h"

uint32_t add_saturated(uint32_t a, uint32_t b) {
  uint32_t sum = a + b;
  return sum < a ? 0xFFFFFFFFu : sum;
}
#endif
