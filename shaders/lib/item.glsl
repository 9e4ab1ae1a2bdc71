// The number of this invocation's item under CommandRecorder::dispatch_items. May be beyond the last: check
// first.
#ifndef PALPATE_LIB_ITEM
#define PALPATE_LIB_ITEM
#include "shaders/shared/base.h"
layout(local_size_x = 64) in;   // kItemGroup

uint32_t item_index() {
  return gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * kItemGroup;
}
#endif
