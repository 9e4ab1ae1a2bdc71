#version 460
// One workgroup: a tile of a tool triangle's sample grid; one invocation: a grid point. Counts the samples that lie in a V_bnd
// or V_int voxel of the mock-up at this pose.
// Reads mobile tiles, the tool in its own frame, the mock-up's partition. Writes mobile_work[].samples.
// Before: mobile_tiles; its list is closed.
#extension GL_GOOGLE_include_directive : require
#include "shaders/lib/frame.glsl"
#include "shaders/lib/voxel_range.glsl"
#include "shaders/shared/frame_response.h"
#include "shaders/lib/sample.glsl"

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
READ(kBindFrameLists, FrameList, frame_lists);
READ(kBindMobileTiles, MobileTile, mobile_tiles);
READ(kBindToolVertices, ivec3, tool_vertices);
READ(kBindToolTriangles, uvec3, tool_triangles);
READ(kBindToolInfo, uint32_t, tool_info);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slots);
READ(kBindMockupBricks, Brick, mockup_bricks);
EDIT(kBindMobileWork, MobileWork, mobile_work);

#include "shaders/lib/pose.glsl"
#define PARTITION(name) mockup_##name
#define PARTITION_GRID scene.mockup.grid
#define PARTITION_SLOTS mockup_brick_slots
#define PARTITION_BRICKS mockup_bricks
#include "shaders/lib/partition.glsl"

shared uint32_t tile_count;

void main() {
  const uint32_t t = flat_group();
  if (gl_LocalInvocationIndex == 0u) tile_count = 0u;
  barrier();
  MobileTile tile = MobileTile(kNone, 0, 0);
  if (t < frame_lists[kListMobileTiles].count) {
    tile = mobile_tiles[t];
    const uvec3 corners = tool_triangles[tile.mobile];
    const ivec3 a = tool_vertices[corners.x], b = tool_vertices[corners.y], c = tool_vertices[corners.z];
    const int32_t axis = int32_t(tool_info[tile.mobile] >> kInfoAxisShift & 3u);
    const SampledTriangle triangle = SampledTriangle(a, b, c, axis, raw_normal(a, b, c));
    const ivec2 g = scene.sample_spacing * (ivec2(tile.first_u, tile.first_v) +
                                            ivec2(gl_LocalInvocationIndex % uint32_t(kMobileTile), gl_LocalInvocationIndex / uint32_t(kMobileTile)));
    if (grid_point_inside(triangle, g)) {
      const ivec3 p = world_from_tool(sample_point(triangle, g));
      if (mockup_class_of(mockup_voxel_of(p)) != kVoxelExternal) atomicAdd(tile_count, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && tile_count != 0u) atomicAdd(mobile_work[tile.mobile].samples, tile_count);
}
