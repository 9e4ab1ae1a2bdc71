// One invocation: an entry of the lists. Merges neighbouring sorted runs of `run` entries into runs of 2·run:
// the entry moves to its place among both runs, which is its rank in the other one. Entries of short lists
// are copied.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"

layout(scalar, set = 0, binding = 0) readonly buffer EntryVoxel { uint32_t entry_voxel[]; };
layout(scalar, set = 0, binding = 1) readonly buffer ListBegin { uint32_t list_begin[]; };
layout(scalar, set = 0, binding = 2) readonly buffer From { uint32_t from[]; };
layout(scalar, set = 0, binding = 3) writeonly buffer To { uint32_t to[]; };
layout(push_constant, scalar) uniform Push { uint32_t count, run; };

void main() {
  uint32_t entry = item_index();
  if (entry >= count) return;
  uint32_t voxel = entry_voxel[entry];
  uint32_t start = list_begin[voxel], end = list_begin[voxel + 1u];
  uint32_t id = from[entry];
  uint32_t mine = (entry - start) / run;                       // number of the run
  uint32_t first = start + (mine & ~1u) * run;                 // of the pair of runs
  uint32_t other = start + (mine ^ 1u) * run;                  // first of the other run
  uint32_t other_end = min(other + run, end);
  uint32_t lo = min(other, end);
  uint32_t hi = max(other_end, lo);
  uint32_t other_begin = lo;
  while (lo < hi) {   // ids in a list are distinct
    uint32_t middle = (lo + hi) >> 1;
    if (from[middle] < id) lo = middle + 1u;
    else hi = middle;
  }
  to[first + (entry - start - mine * run) + (lo - other_begin)] = id;
}
