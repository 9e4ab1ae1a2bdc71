// How deep a lattice point lies below the surface of a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4, "Depth"), exact. Floats say which triangles may be the nearest; integers
// decide among those few when all have been seen, for llvmpipe runs exact distances for all lanes that stand
// side by side as soon as one asks.
// The including shader has what lib/body/body.glsl asks for, ivec3 body_normals[] and frame_state (writable).
#ifndef PALPATE_LIB_BODY_DEPTH
#define PALPATE_LIB_BODY_DEPTH
#include "shaders/shared/frame_field.h"
#include "shaders/lib/body/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/distance.glsl"
#include "shaders/lib/distance_estimate.glsl"

struct Depth {
  int32_t steps;       // φ
  uint32_t triangle;   // the nearest one, of several the smallest id; kNone: there is none
};

const uint32_t kKept = 8u;
const float kFar = 4294967296.0;   // beyond every distance

// What may be the nearest. A place is free where `least` is beyond `reach`.
struct NearTriangles {
  float reach;   // what is further is not the nearest
  uint32_t id[kKept];
  float least[kKept];
};

NearTriangles none_near(float reach) {
  NearTriangles near;
  near.reach = reach;
  for (uint32_t i = 0u; i < kKept; ++i) {
    near.id[i] = kNone;
    near.least[i] = 2.0 * kFar;
  }
  return near;
}

DistanceBounds bounds_of(uint32_t id, ivec3 p) {
  if (!body_bounds_solid(id)) return DistanceBounds(2.0 * kFar, kFar);
  const uvec3 ids = body_triangles[id];
  return distance_bounds(body_vertices[ids.x], body_vertices[ids.y], body_vertices[ids.z], body_normals[id], p);
}

// Keeps a triangle if it may be the nearest. False: there is no room.
bool keep_near(uint32_t id, ivec3 p, inout NearTriangles near) {
  const DistanceBounds bounds = bounds_of(id, p);
  near.reach = min(near.reach, bounds.most);
  uint32_t place = kKept;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.least[i] > near.reach) place = i;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.id[i] == id) place = i;   // another voxel lists it, too
  if (bounds.least > near.reach) return true;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (i == place) {
      near.id[i] = id;
      near.least[i] = bounds.least;
    }
  return place != kKept;
}

// Integers on what has been kept.
void decide_nearest(ivec3 p, NearTriangles near, inout Depth best) {
  uint32_t open = 0u;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.least[i] <= near.reach) open |= 1u << i;
  while (open != 0u && !spent(1u)) {
    const uint32_t id = near.id[findLSB(open)];
    open &= open - 1u;
    const uvec3 ids = body_triangles[id];
    const ivec3 a = body_vertices[ids.x], n = body_normals[id];
    const int32_t steps =
        distance_at(height_above(n, a, p), n, a, body_vertices[ids.y], body_vertices[ids.z], p);
    if (steps < best.steps || (steps == best.steps && id < best.triangle)) best = Depth(steps, id);
  }
}

// Whether a closed box that is so far away along each axis reaches there.
bool reaches(float reach, ivec3 p, ivec3 low, ivec3 high) {
  const vec3 gap = vec3(max(max(low - p, p - high), ivec3(0)));
  return gap.x * gap.x + gap.y * gap.y + gap.z * gap.z <= reach * reach * 1.0001;
}

// How far the nearest triangle is at most: by what the nearest V_bnd voxels along the axes list, the point's
// own first; kFar where there is none.
float reach_along_axes(ivec3 p, ivec3 home) {
  const ivec3 cells = 8 * BODY_GRID.bricks;
  const int32_t last_ring = max(cells.x, max(cells.y, cells.z));
  float reach = kFar;
  int32_t ring = 0;
  uint32_t way = 0u, entry = 0u, last = 0u;
  while (!spent(1u)) {
    if (entry == last) {
      if (way == 6u) {
        if (reach < kFar || ring == last_ring) break;
        way = 0u;
        ++ring;
      }
      ivec3 voxel = home;
      voxel[int(way >> 1)] += (way & 1u) != 0u ? ring : -ring;
      way = ring == 0 ? 6u : way + 1u;
      const uint32_t boundary = body_boundary_index(voxel);
      if (boundary == kNoVoxel) continue;
      entry = body_list_begin[boundary];
      last = body_list_begin[boundary + 1u];
    }
    reach = min(reach, bounds_of(body_list[entry++], p).most);
  }
  return reach;
}

// Bits of a brick's word (4 rows of 8 voxels, from y on) within low … high of the brick.
uint32_t word_bits(int32_t y, ivec3 low, ivec3 high) {
  const int32_t first = max(low.y - y, 0), end = min(high.y - y, 3);
  if (first > 3 || end < 0) return 0u;
  const uint32_t row = 0xFFu >> uint32_t(7 - high.x) & 0xFFu << uint32_t(low.x);
  return row * 0x01010101u & 0xFFFFFFFFu >> uint32_t(8 * (3 - end)) & 0xFFFFFFFFu << uint32_t(8 * first);
}

const Depth kNoDepth = Depth(0x7FFFFFFF, kNone);

// Of those within reach, `part` and every LANES-th entry of a list from there on.
Depth nearest_within(float reach, ivec3 p, uint32_t part) {
  Depth best = kNoDepth;
  NearTriangles near = none_near(reach);

  // All voxels within reach of what was found, brick by brick, as far as they may hold something nearer.
  const int32_t size = BODY_GRID.size;
  ivec3 low = ivec3(0), high = 8 * BODY_GRID.bricks - 1;
  if (near.reach < kFar / 8.0) {   // 2^29, so that sums fit
    const int32_t reach = int32_t(near.reach) + 1;
    low = max(low, body_voxel_of(p - reach));
    high = min(high, body_voxel_of(p + reach));
  }
  const ivec3 first = low >> 3, end = high >> 3;
  ivec3 brick = first;
  uint32_t slot = 0u, word = 0u, words = 0u, bits = 0u, whole = 0u, entry = 0u, last = 0u;
  ivec3 in_low = ivec3(0), in_high = ivec3(0), at = first;   // `at`: the present brick; `brick`: the next one
  bool more = true;
  while (more && !spent(1u)) {
    bool room = true;
    while (room && !spent(1u)) {
      if (entry < last) {
        room = keep_near(body_list[entry], p, near);
        entry += room ? LANES : 0u;
      } else if (bits != 0u) {
        const uint32_t bit = uint32_t(findLSB(bits));
        bits &= bits - 1u;
        const ivec3 voxel = 8 * at + ivec3(bit & 7u, 4u * (word & 1u) + (bit >> 3), word >> 1);
        const ivec3 corner = BODY_GRID.origin + size * voxel;
        if (!reaches(near.reach, p, corner, corner + size)) continue;
        const uint32_t boundary =
            body_bricks[slot].first[word] + uint32_t(bitCount(whole & ((1u << bit) - 1u)));
        entry = body_list_begin[boundary] + part;
        last = body_list_begin[boundary + 1u];
      } else if (word + 1u < words) {
        ++word;
        const uint32_t wanted = word_bits(int32_t(4u * (word & 1u)), in_low, in_high);
        if (wanted == 0u) continue;
        whole = body_bricks[slot].boundary[word];
        bits = whole & wanted;
      } else {
        more = all(lessThanEqual(brick, end));
        if (!more) break;
        at = brick;
        brick = ivec3(brick.x + 1, brick.yz);
        if (brick.x > end.x) brick = ivec3(first.x, brick.y + 1, brick.z);
        if (brick.y > end.y) brick = brick.z < end.z ? ivec3(first.xy, brick.z + 1) : end + 1;
        slot = body_slot_of(at);
        words = 0u;
        const ivec3 corner = BODY_GRID.origin + 8 * size * at;
        if (slot >= kBrickInternal || !reaches(near.reach, p, corner, corner + 8 * size)) continue;
        in_low = clamp(low - 8 * at, ivec3(0), ivec3(7));
        in_high = clamp(high - 8 * at, ivec3(0), ivec3(7));
        word = 2u * uint32_t(in_low.z) - 1u;   // the one before the first; runs round at 0
        words = 2u * uint32_t(in_high.z) + 2u;
      }
    }
    decide_nearest(p, near, best);
    near = none_near(min(near.reach, float(best.steps) + float(2 * kDepthSlack)));
  }
  return best;
}

// What the invocations of a workgroup have found, which look for a point's depth together.
shared uint32_t found_reach[kGroupSize];   // rounded up; kNone: nothing
shared int32_t found_steps[kGroupSize];
shared uint32_t found_nearest[kGroupSize];

// Of the whole workgroup, LANES invocations that follow each other with the same point, and `asks` false where
// they have none.
Depth body_depth(bool asks, ivec3 p) {
  if (LANES == 1u) return asks ? nearest_within(reach_along_axes(p, body_voxel_of(p)), p, 0u) : kNoDepth;
  const uint32_t lane = gl_LocalInvocationIndex, part = lane % LANES, first = lane - part;
  float reach = kFar;
  const uint32_t home = asks ? body_boundary_index(body_voxel_of(p)) : kNoVoxel;
  if (home != kNoVoxel)
    for (uint32_t i = body_list_begin[home] + part; i < body_list_begin[home + 1u] && !spent(1u); i += LANES)
      reach = min(reach, bounds_of(body_list[i], p).most);
  found_reach[lane] = reach < kFar ? uint32_t(reach) + 1u : kNone;
  barrier();
  uint32_t least = kNone;
  for (uint32_t i = first; i < first + LANES; ++i) least = min(least, found_reach[i]);
  Depth best = kNoDepth;
  if (asks) {
    // As a float it may be a 2^-24th less.
    reach = least != kNone ? float(least) * (1.0 + 1.0 / 4194304.0) : reach_along_axes(p, body_voxel_of(p));
    best = nearest_within(reach, p, part);
  }
  found_steps[lane] = best.steps;
  found_nearest[lane] = best.triangle;
  barrier();
  for (uint32_t i = first; i < first + LANES; ++i)
    if (found_steps[i] < best.steps || (found_steps[i] == best.steps && found_nearest[i] < best.triangle))
      best = Depth(found_steps[i], found_nearest[i]);
  return best;
}
#endif
