// Bounds of preparation, for its shaders and compute/.
#ifndef PALPATE_SHARED_PREPARE_H
#define PALPATE_SHARED_PREPARE_H
#include "shaders/shared/base.h"

PALPATE_SHARED_BEGIN

PALPATE_CONSTANT uint32_t kScanChunk = 64u;   // numbers that one invocation of a prefix sum adds

PALPATE_SHARED_END
#endif
