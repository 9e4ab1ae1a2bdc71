#version 460
#extension GL_GOOGLE_include_directive : require
// The search: what of tool and mock-up may meet at the pose. It may name too much, never too little.
// A run is 8 tool triangles, a cluster is 8 runs (kRunSize, kClusterSize); a brick is 8 x 8 x 8 voxels.
//  - The first workgroups look for runs of the tool that come near what is not V_ext. Each has CLUSTERS:
//    an invocation asks one cluster, and then runs of those clusters that are near.
//  - The other BRICK_GROUPS look for V_bnd voxels of the mock-up that the tool's solid may reach into, and so
//    for samples. They take in turn the bricks that the tool's fine grid may meet, BRICKS_AT_ONCE in a round:
//    an invocation asks one brick, and all of them then voxels of those bricks that are near, brick by brick.
// In a batch each pose has as many workgroups, in a row of its own.
// Reads boxes of the tool, occupied cubes and both partitions; appends near_runs and sample_chunks.
#include "shaders/lib/frame.glsl"

layout(constant_id = 0) const uint32_t SAMPLES = 2u;   // 1: chunks of voxels' lists; 2: of listed points
layout(constant_id = 1) const bool HAS_NEAR = true;    // false: tool_near says nothing
layout(constant_id = 2) const uint32_t BRICK_GROUPS = 2u;   // workgroups that look for bricks, …
layout(constant_id = 3) const uint32_t BRICKS_AT_ONCE = 64u;   // … each so many in a round, kGroupSize at most
layout(constant_id = 4) const uint32_t CLUSTERS = 64u;   // of a workgroup, kGroupSize at most

CONSTANT(kBindScene, SceneConstants, scene);
CONSTANT(kBindFrameInput, FrameInput, frame_input);
EDIT(kBindFrameLists, FrameList, frame_lists);
#include "shaders/lib/batch/batch.glsl"
READ(kBindToolBounds, LatticeBox, tool_bounds);
READ(kBindOccupied, uint32_t, occupied);
READ(kBindMockupBrickSlot, uint32_t, mockup_brick_slot);
READ(kBindMockupBricks, Brick, mockup_bricks);
READ(kBindMockupListBegin, uint32_t, mockup_list_begin);
READ(kBindMockupBoundaryPlace, uint32_t, boundary_place);
READ(kBindToolNear, uint32_t, tool_near);
READ(kBindSampleBegin, uint32_t, sample_begin);
EDIT(kBindNearRuns, NearRun, near_runs);
EDIT(kBindSampleChunks, SampleChunk, sample_chunks);

#include "shaders/lib/list_room.glsl"
#include "shaders/lib/broad_phase/turned_box.glsl"
#include "shaders/lib/broad_phase/occupied.glsl"
#include "shaders/lib/group_count.glsl"
GROUP_COUNTS(kBindNearGroups, near_groups)

shared uint32_t near_items[kGroupSize];   // clusters, or bricks by their numbers in the range
shared uint32_t near_count;

bool is_near(uint32_t bounds, out ivec3 first, out ivec3 last) {
  const LatticeBox box = tool_bounds[bounds];
  return box.low.x <= box.high.x && voxels_of_turned(box.low, box.high, first, last) &&
         may_be_occupied(first, last);
}

void append(NearRun part) {
  const uint32_t at = take_room(kListNearRuns, 1u);
  if (at >= frame_lists[kListNearRuns].capacity) return;
  near_runs[at] = part;
  if (at % RUNS_A_GROUP == 0u) grow_near_groups(kGroupsTouch, at / RUNS_A_GROUP + 1u);
}

// As it is, or in slabs of bricks along z, bars of those along y, or pieces of those.
void append_parts(uint32_t run, ivec3 first, ivec3 last) {
  const vec3 n = vec3(last - first + 1);
  const float most = max(float(kBricksAPart), n.x * n.y * n.z / float(kMostParts));
  // No fewer than one, no more than there are.
  const ivec3 part = ivec3(clamp(vec3(most, most / n.x, most / (n.x * n.y)), vec3(1.0), n));
  for (int32_t z = first.z; z <= last.z && !spent(1u); z += part.z)
    for (int32_t y = first.y; y <= last.y && !spent(1u); y += part.y)
      for (int32_t x = first.x; x <= last.x && !spent(1u); x += part.x) {
        const ivec3 low = ivec3(x, y, z);
        const uvec3 range = uvec3(low | min(low + part - 1, last) << 16);
        append(NearRun(run, range.x, range.y, range.z, frame_pose));
      }
}

void cull_tool(uint32_t lane, uint32_t group) {
  const uint32_t runs = (scene.tool.triangles + kRunSize - 1u) / kRunSize,
                 clusters = (scene.tool.triangles + kClusterSize - 1u) / kClusterSize;
  const uint32_t cluster = group * CLUSTERS + lane;
  ivec3 first, last;
  if (lane < CLUSTERS && cluster < clusters && is_near(cluster, first, last)) near_items[atomicAdd(near_count, 1u)] = cluster;
  barrier();
  const uint32_t each = kClusterSize / kRunSize;
  for (uint32_t i = lane; i < each * near_count; i += kGroupSize) {
    const uint32_t run = each * near_items[i / each] + i % each;
    if (run < runs && is_near(clusters + run, first, last)) append_parts(run, first >> 3, last >> 3);
  }
}

// Whether the tool's fine grid may reach into a brick of the mock-up.
bool grid_near(ivec3 brick) {
  const int32_t half_side = 4 * scene.mockup.grid.size;
  const ivec3 centre = tool_from_world(scene.mockup.grid.origin + half_side * (2 * brick + 1));
  ivec3 reach;
  for (int c = 0; c < 3; ++c)
    reach[c] = int32_t((abs(float(INPUT(rotation_q30[c]))) + abs(float(INPUT(rotation_q30[3 + c]))) +
                        abs(float(INPUT(rotation_q30[6 + c])))) *
                       (float(half_side) * ((1.0 + 1.0 / 1048576.0) / 1073741824.0))) + 4;
  const ivec3 low = scene.fine.origin, high = low + 8 * scene.fine.size * scene.fine.bricks;
  return all(greaterThanEqual(centre + reach, low)) && all(lessThanEqual(centre - reach, high));
}

// Whether the tool's solid may reach into a voxel of the mock-up with this centre (tool lattice point).
bool solid_near(ivec3 centre) {
  // What is beyond the grid sees its nearest voxel of the solid from the border: the grid is padded by two.
  const ivec3 n = 8 * scene.fine.bricks, d = centre - scene.fine.origin;
  if (any(lessThan(d, ivec3(-scene.mockup.grid.size))) ||
      any(greaterThan(d, n * scene.fine.size + scene.mockup.grid.size)))
    return false;
  if (!HAS_NEAR) return true;
  const uvec3 v = uvec3(clamp(cell_along(d, scene.fine.size, n), ivec3(0), n - 1));
  const uint32_t i = v.x + uint32_t(n.x) * (v.y + uint32_t(n.y) * v.z);
  return (tool_near[i >> 5] >> (i & 31u) & 1u) != 0u;
}

void append_chunks(ivec3 voxel, uint32_t boundary) {
  const bool listed = SAMPLES == 2u;
  const uint32_t begin = listed ? sample_begin[boundary] : mockup_list_begin[boundary],
                 end = listed ? sample_begin[boundary + 1u] : mockup_list_begin[boundary + 1u];
  const uint32_t chunk = chunk_of(end - begin, listed ? LISTED_CHUNK : kSampleChunk, kMostSampleChunks),
                 chunks = (end - begin + chunk - 1u) / chunk;
  // An invocation of sample_scan goes through a chunk's cells of samples.
  const uint32_t along = uint32_t(scene.mockup.grid.size / scene.sample_spacing) + 2u;
  if (!listed && chunk > kSampleChunk && chunk * along * along > kLoopBudget) {
    atomicOr(frame_state.overflow_other, kOverflowLoop);
    return;
  }
  if (chunks == 0u) return;
  const uint32_t at = take_room(kListSampleChunks, chunks),
                 capacity = frame_lists[kListSampleChunks].capacity;
  if (at < capacity && begins_group(at, chunks))
    grow_near_groups(kGroupsSamples, groups_to(min(at + chunks, capacity)));
  for (uint32_t i = 0u; i < chunks && at + i < capacity && !spent(1u); ++i)
    sample_chunks[at + i] =
        SampleChunk(voxel + ivec3(0, 0, BATCH ? int32_t(frame_pose << 16) : 0), begin + i * chunk,
                    min(begin + (i + 1u) * chunk, end));
}

void cull_samples(uint32_t lane, uint32_t group) {
  // Bricks of the mock-up that the tool's fine grid may meet; all of its solid lies in that.
  ivec3 first, last;
  const ivec3 low = scene.fine.origin;
  const bool any = voxels_of_turned(low, low + 8 * scene.fine.size * scene.fine.bricks, first, last);
  first >>= 3;
  const uvec3 n = any ? uvec3((last >> 3) - first + 1) : uvec3(0u);
  const ivec3 all_bricks = scene.mockup.grid.bricks;
  const int32_t size = scene.mockup.grid.size;
  const uint32_t count = n.x * n.y * n.z, all = BRICK_GROUPS * BRICKS_AT_ONCE,
                 rounds = (count + all - 1u) / all;
  uint32_t item = group * BRICKS_AT_ONCE + lane;
  for (uint32_t round = 0u; round < rounds; ++round, item += all) {
    if (lane < BRICKS_AT_ONCE && item < count) {
      const ivec3 brick = first + ivec3(item % n.x, item / n.x % n.y, item / (n.x * n.y));
      const uint32_t number = uint32_t(brick.x + all_bricks.x * (brick.y + all_bricks.y * brick.z));
      if (mockup_brick_slot[number] < kBrickInternal && grid_near(brick))
        near_items[atomicAdd(near_count, 1u)] = number;
    }
    barrier();
    const uint32_t near = near_count;
    for (uint32_t i = 0u; i < near; ++i) {
      const uint32_t slot = mockup_brick_slot[near_items[i]];
      const ivec3 brick = 8 * brick_at(near_items[i], all_bricks);
      const uint32_t end =
          mockup_bricks[slot].first[15] + uint32_t(bitCount(mockup_bricks[slot].boundary[15]));
      for (uint32_t b = mockup_bricks[slot].first[0] + lane; b < end; b += kGroupSize) {
        const ivec3 voxel = brick + voxel_at(boundary_place[b] & 511u);
        if (solid_near(tool_from_world(scene.mockup.grid.origin + size * voxel + size / 2)))
          append_chunks(voxel, b);
      }
    }
    barrier();
    if (lane == 0u) near_count = 0u;
    barrier();
  }
}

void main() {
  const uint32_t lane = gl_LocalInvocationIndex, group = BATCH ? gl_WorkGroupID.x : flat_group();
  const uint32_t all = kClusterSize * CLUSTERS, tool_groups = (scene.tool.triangles + all - 1u) / all;
  take_pose(gl_WorkGroupID.y);
  if (lane == 0u) near_count = 0u;
  barrier();
  if (group < tool_groups)
    cull_tool(lane, group);
  else if (SAMPLES != 0u)
    cull_samples(lane, group - tool_groups);
  tell_spent();
}
