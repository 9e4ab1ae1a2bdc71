// One invocation: a row of bricks along `axis`. Links its mixed bricks from the far end to the near one, or
// the other way round: row_head[row] is the slot of the first, row_link[slot] the next, kNoVoxel ends.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/cells.glsl"
#include "shaders/lib/item.glsl"
#include "shaders/shared/prepare.h"
#include "shaders/shared/scene.h"

layout(constant_id = 0) const bool FROM_NEAR = false;

layout(scalar, set = 0, binding = 0) readonly buffer BrickSlot { uint32_t brick_slot[]; };
layout(scalar, set = 0, binding = 1) writeonly buffer RowHead { uint32_t row_head[]; };
layout(scalar, set = 0, binding = 2) writeonly buffer RowLink { uint32_t row_link[]; };
layout(push_constant, scalar) uniform Push { GridPush push; };

void main() {
  uint32_t row = item_index();
  if (row >= push.count) return;
  uint32_t u = (push.axis + 1u) % 3u, v = (push.axis + 2u) % 3u;
  ivec3 brick = ivec3(0);
  brick[u] = int32_t(row % uint32_t(push.bricks[u]));
  brick[v] = int32_t(row / uint32_t(push.bricks[u]));
  uint32_t last = kNoVoxel;
  const int32_t most = push.bricks[push.axis] - 1;
  for (int32_t k = 0; k <= most; ++k) {
    brick[push.axis] = FROM_NEAR ? k : most - k;
    uint32_t slot = brick_slot[cell_number(brick, push.bricks)];
    if (slot >= kBrickInternal) continue;
    if (last == kNoVoxel) row_head[row] = slot;
    else row_link[last] = slot;
    last = slot;
  }
  if (last == kNoVoxel) row_head[row] = kNoVoxel;
  else row_link[last] = kNoVoxel;
}
