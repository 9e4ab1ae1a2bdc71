// How deep a lattice point lies below a body's surface, looked for by one invocation alone: along the voxels'
// lists, for llvmpipe pays much for barriers. lib/body/body_depth.glsl includes it.
#ifndef PALPATE_LIB_BODY_DEPTH_ALONE
#define PALPATE_LIB_BODY_DEPTH_ALONE

DistanceBounds solid_bounds_of(uint32_t id, ivec3 p) {
  if (!body_bounds_solid(id)) return DistanceBounds(2.0 * kFar, kFar);
  return bounds_of(id, p);
}

const uint32_t kKept = 8u;

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

// Keeps a triangle if it may be the nearest. False: there is no room.
bool keep_near(uint32_t id, ivec3 p, inout NearTriangles near) {
  const DistanceBounds bounds = solid_bounds_of(id, p);
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
void decide_kept(ivec3 p, NearTriangles near, inout Depth best) {
  uint32_t open = 0u;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.least[i] <= near.reach) open |= 1u << i;
  while (open != 0u && !spent(1u)) {
    decide_nearest(p, near.id[findLSB(open)], best);
    open &= open - 1u;
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
    reach = min(reach, solid_bounds_of(body_list[entry++], p).most);
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

// Of those within reach.
Depth nearest_within(float reach, ivec3 p) {
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
        entry += uint32_t(room);
      } else if (bits != 0u) {
        const uint32_t bit = uint32_t(findLSB(bits));
        bits &= bits - 1u;
        const ivec3 voxel = 8 * at + ivec3(bit & 7u, 4u * (word & 1u) + (bit >> 3), word >> 1);
        const ivec3 corner = BODY_GRID.origin + size * voxel;
        if (!reaches(near.reach, p, corner, corner + size)) continue;
        const uint32_t boundary =
            body_bricks[slot].first[word] + uint32_t(bitCount(whole & ((1u << bit) - 1u)));
        entry = body_list_begin[boundary];
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
    decide_kept(p, near, best);
    near = none_near(min(near.reach, float(best.steps) + float(2 * kDepthSlack)));
  }
  return best;
}

Depth depth_alone(ivec3 p) { return nearest_within(reach_along_axes(p, body_voxel_of(p)), p); }
#endif
