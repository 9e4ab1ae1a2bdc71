// The crossings of a ray with a closed tool, found along the ray: through the tool's fine partition, voxel by voxel, from the sample
// until it is out of the tool. Each voxel lists all that can be crossed in it (lib/tool_ray.glsl has the rest).
// The including shader declares scene, frame_input, fine_…[] (partition), fine_places[], tool_records[], frame_state (writable).
//
// *Each crossing once.* The ray is cut at heights T0 = 0 < T1 < T2 …; a crossing of height H counts in the voxel with T(i) <= H < T(i+1).
// *Each crossing is listed there.* In the tool's frame the ray is at (base + step·T) / 2^30. T(i) is in voxel i. T(i+1) - 1 is not beyond its face:
// floats, off by less than 2^-20 of the way, estimate it from below; so T(i+1) is beyond by less than a height's step, 0.87 steps an axis.
// Rounding `step` moves the ray by half a step at T = 2^30: a ray from inside a tool of radius 2^27 is out of it by then, for |d| >= 2^28.
// Where the ray meets a triangle of the rounded, transformed tool, the triangle as it was loaded is within 0.87 steps (vertices rounded by half a
// step an axis) and 0.3 (R's own rounding: its entries are 2^-31 at most off a rotation's, so a row of R^T R - 1 is at most (3 + sqrt 3) 2^-31
// long; times 2^27). All that comes to 2.6 steps, less than kToolVoxelGrowth, by which voxels were grown before they were asked what they touch.
// No tool is larger: the mock-up's grid and twice the tool's radius have room in 2^28 (model/geometry_build.cpp).
// *When to stop.* In a V_ext voxel the winding is 0: the signs of what is left add up to 0, and `total` is known.
#ifndef PALPATE_LIB_TOOL_WALK
#define PALPATE_LIB_TOOL_WALK
#include "shaders/lib/pose.glsl"
#include "shaders/lib/tool_record.glsl"
#include "shaders/lib/voxel_range.glsl"

#define PARTITION_GRID scene.fine
#define PARTITION_SLOTS fine_brick_slot
#define PARTITION_BRICKS fine_bricks
#define PARTITION(name) fine_##name
#include "shaders/lib/partition.glsl"

const uint32_t kHighest = 1u << 31;   // no crossing is higher
const uint32_t kPutBy = 8u;   // triangles put by for the exact test (chosen: a ray out of a tool has 1 to 3)

// As tool_sweep.
Levels tool_walk(ivec3 p, ivec3 d, uint32_t from, out int32_t total) {
  Levels levels;
  levels.count = 0u;
  total = 0;
  const i64vec3 off = i64vec3(p) - i64vec3(frame_input.translation), along = i64vec3(d);
  i64vec3 base;   // Q30; |off| < 2^31: within 3 · 2^61
  ivec3 step;     // Q30 of a height; |d| < 2^29 · 1.74: below 2^30
  for (int c = 0; c < 3; ++c) {
    const i64vec3 column = i64vec3(frame_input.rotation_q30[c], frame_input.rotation_q30[3 + c], frame_input.rotation_q30[6 + c]);
    base[c] = column.x * off.x + column.y * off.y + column.z * off.z;
    step[c] = int32_t((column.x * along.x + column.y * along.y + column.z * along.z + (1l << 29)) >> 30);
  }
  const ivec3 start = ivec3(base >> 30);
  const vec3 e = vec3(step) * (1.0 / 1073741824.0), per_step = 1073741824.0 / max(abs(vec3(step)), vec3(1.0));
  const bvec3 still = equal(step, ivec3(0));
  const float kMostAway = 536870912.0;   // so that heights stay below 2^32; a voxel that is longer is come to twice
  const ivec3 cells = 8 * scene.fine.bricks;
  const int32_t size = scene.fine.size;

  uint32_t put_by[kPutBy], begins[kPutBy], ends[kPutBy];
  uint32_t t = 0u, t_end = 0u, entry = 0u, last = 0u;   // the voxel's part of the ray and of its list
  bool crossed = false, done = false;
  while (!done && !spent(1u)) {
    uint32_t count = 0u;
    bool out_of_it = false;
    while (!out_of_it && count < kPutBy && !spent(1u)) {
      if (entry == last) {   // the next voxel
        t = t_end;
        const i64vec3 at = base + i64vec3(step) * int64_t(t);
        const ivec3 q = ivec3(at >> 30), voxel = cell_along(q - scene.fine.origin, size, cells);
        if (t > kHighest || !fine_in_grid(voxel)) {
          done = true;
          out_of_it = true;
        } else {
          const ivec3 face = scene.fine.origin + (voxel + ivec3(greaterThan(step, ivec3(0)))) * size;
          for (int pass = 0; pass < 2; ++pass) {   // what the first leaves of the way is so short that the second leaves less than a height's step
            const i64vec3 from_here = base + i64vec3(step) * int64_t(t_end);
            const vec3 rest = vec3(face - ivec3(from_here >> 30)) - vec3(from_here & 0x3FFFFFFFl) * (1.0 / 1073741824.0);
            const vec3 away = mix(abs(rest) * per_step, vec3(kMostAway), still);
            t_end += uint32_t(min(min(away.x, away.y), min(away.z, kMostAway)) * (1.0 - 1.0 / 1048576.0));
          }
          ++t_end;
          const uint32_t boundary = fine_boundary_index(voxel);
          if (boundary != kNoVoxel) {
            entry = fine_list_begin[boundary];
            last = fine_list_begin[boundary + 1u];
          } else {
            out_of_it = (crossed || count != 0u) && fine_class_of(voxel) == kVoxelExternal;
          }
        }
      }
      // All of the list that there is room for.
      for (; entry < last && count < kPutBy && !spent(1u); ++entry) {
        const uint32_t place = fine_places[entry];
        const RecordCorners r = record_at(place);
        if (!ray_may_meet_triangle(start, e, r.a, r.b, r.c)) continue;
        put_by[count] = place;
        begins[count] = t;
        ends[count] = t_end;
        ++count;
      }
    }
    for (uint32_t k = 0u; k < count && !spent(1u); ++k) {
      const RecordCorners r = record_at(put_by[k]);
      const Crossing crossing = ray_crossing(p, d, world_from_tool(r.a), world_from_tool(r.b), world_from_tool(r.c));
      if (crossing.sign == 0 || crossing.height < begins[k] || crossing.height >= ends[k]) continue;
      crossed = true;
      total += crossing.sign;
      if (crossing.height < from || spent(2u * kLevels)) continue;
      levels_insert(levels, crossing.height, crossing.sign, put_by[k]);
    }
    if (out_of_it && crossed) done = true;
  }
  return levels;
}
#endif
