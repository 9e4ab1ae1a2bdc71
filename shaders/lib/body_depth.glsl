// How deep a lattice point lies below the surface of a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4, "Depth"), exact.
// The including shader has what lib/body.glsl asks for, ivec3 body_normals[] and frame_state (writable).
#ifndef PALPATE_LIB_BODY_DEPTH
#define PALPATE_LIB_BODY_DEPTH
#include "shaders/shared/frame_field.h"
#include "shaders/lib/body.glsl"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/distance.glsl"

struct Depth {
  int32_t steps;       // φ
  uint32_t triangle;   // the nearest one, of several the smallest id; kNone: there is none
};

// How far p is from a closed box along each axis.
ivec3 box_gap(ivec3 p, ivec3 low, ivec3 high) { return max(max(low - p, p - high), ivec3(0)); }

// Whether what is that far away may be as near as the best so far.
bool may_be_nearer(ivec3 gap, Depth best) {
  if (best.triangle == kNone) return true;
  const int64_t reach = int64_t(best.steps) + int64_t(kDepthSlack);
  return wide_dot(gap, gap) <= reach * reach;
}

// How far p lies on the outer side of the edge from u to v, in floats. Coordinates, components of n, products
// and sums are rounded by 2^-24 each, the root and the quotient by less than 2^-21: off by less than 2^-18 of
// the way from u (derived: 20 · 2^-24); what section 4 computes, by less than 4 steps.
const float kEstimate = 1.0 / 262144.0;

float edge_estimate(ivec3 u, ivec3 v, ivec3 n, ivec3 p) {
  const vec3 e = vec3(v - u), m = vec3(n) * (1.0 / 1073741824.0), f = vec3(p - u);
  const vec3 across = e.yzx * m.zxy - e.zxy * m.yzx;
  return (across.x * f.x + across.y * f.y + across.z * f.z) / sqrt(e.x * e.x + e.y * e.y + e.z * e.z);
}

float reach_of(ivec3 d) {
  const vec3 f = abs(vec3(d));
  return f.x + f.y + f.z;
}

// The distance to a triangle, where it may be the least.
void look_at(uint32_t id, ivec3 p, inout Depth best) {
  if (id == best.triangle || !body_bounds_solid(id)) return;
  const uvec3 ids = body_triangles[id];
  const ivec3 a = body_vertices[ids.x], b = body_vertices[ids.y], c = body_vertices[ids.z];
  if (!may_be_nearer(box_gap(p, min(min(a, b), c), max(max(a, b), c)), best)) return;
  const ivec3 n = body_normals[id];
  const int32_t height = height_above(n, a, p);
  if (height > best.steps) return;
  // Floats first: on the inner side of all edges the height is the distance, and beyond one of them nothing
  // is nearer than that edge's line.
  const vec3 sides = vec3(edge_estimate(a, b, n, p), edge_estimate(b, c, n, p), edge_estimate(c, a, n, p));
  const vec3 slack = 8.0 + kEstimate * vec3(reach_of(p - a), reach_of(p - b), reach_of(p - c));
  const vec3 beyond = max(sides - slack, vec3(0.0));
  const float out_by = max(beyond.x, max(beyond.y, beyond.z)), h = float(height),
              near = float(best.steps) + float(kDepthSlack);
  if (h * h + out_by * out_by > near * near * 1.0001) return;
  const int32_t steps = all(lessThan(sides, -slack)) ? height : distance_at(height, n, a, b, c, p);
  if (steps < best.steps || (steps == best.steps && id < best.triangle)) best = Depth(steps, id);
}

// Something near: what the nearest V_bnd voxels along the axes list, the point's own first. One loop does all
// of it (see lib/body_walks.glsl).
void look_along_axes(ivec3 p, ivec3 home, inout Depth best) {
  const ivec3 cells = 8 * BODY_GRID.bricks;
  const int32_t last_ring = max(cells.x, max(cells.y, cells.z));
  int32_t ring = 0;
  uint32_t way = 0u, entry = 0u, last = 0u;
  while (!spent(1u)) {
    if (entry < last) {
      look_at(body_list[entry++], p, best);
      continue;
    }
    if (way == 6u) {
      if (best.triangle != kNone || ring == last_ring) return;
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
}

// Bits of a brick's word (4 rows of 8 voxels, from y on) within low … high of the brick.
uint32_t word_bits(int32_t y, ivec3 low, ivec3 high) {
  const int32_t first = max(low.y - y, 0), end = min(high.y - y, 3);
  if (first > 3 || end < 0) return 0u;
  const uint32_t row = 0xFFu >> uint32_t(7 - high.x) & 0xFFu << uint32_t(low.x);
  return row * 0x01010101u & 0xFFFFFFFFu >> uint32_t(8 * (3 - end)) & 0xFFFFFFFFu << uint32_t(8 * first);
}

Depth body_depth(ivec3 p) {
  Depth best = Depth(0x7FFFFFFF, kNone);
  const ivec3 home = body_voxel_of(p);
  look_along_axes(p, home, best);

  // All voxels within reach of what was found, brick by brick, as far as they may hold something nearer.
  const int32_t size = BODY_GRID.size;
  ivec3 low = ivec3(0), high = 8 * BODY_GRID.bricks - 1;
  if (best.triangle != kNone) {
    const int32_t reach = best.steps + kDepthSlack;
    low = max(low, body_voxel_of(p - reach));
    high = min(high, body_voxel_of(p + reach));
  }
  const ivec3 first = low >> 3, end = high >> 3;
  ivec3 brick = first;
  uint32_t slot = 0u, word = 0u, words = 0u, bits = 0u, whole = 0u, entry = 0u, last = 0u;
  ivec3 in_low = ivec3(0), in_high = ivec3(0), at = first;   // `at`: the present brick; `brick`: the next one
  while (!spent(1u)) {
    if (entry < last) {
      look_at(body_list[entry++], p, best);
    } else if (bits != 0u) {
      const uint32_t bit = uint32_t(findLSB(bits));
      bits &= bits - 1u;
      const ivec3 voxel = 8 * at + ivec3(bit & 7u, 4u * (word & 1u) + (bit >> 3), word >> 1);
      const ivec3 corner = BODY_GRID.origin + size * voxel;
      if (voxel == home || !may_be_nearer(box_gap(p, corner, corner + size), best)) continue;
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
      if (any(greaterThan(brick, end))) break;
      at = brick;
      brick = ivec3(brick.x + 1, brick.yz);
      if (brick.x > end.x) brick = ivec3(first.x, brick.y + 1, brick.z);
      if (brick.y > end.y) brick = brick.z < end.z ? ivec3(first.xy, brick.z + 1) : end + 1;
      slot = body_slot_of(at);
      words = 0u;
      const ivec3 corner = BODY_GRID.origin + 8 * size * at;
      if (slot >= kBrickInternal || !may_be_nearer(box_gap(p, corner, corner + 8 * size), best)) continue;
      in_low = clamp(low - 8 * at, ivec3(0), ivec3(7));
      in_high = clamp(high - 8 * at, ivec3(0), ivec3(7));
      word = 2u * uint32_t(in_low.z) - 1u;   // the one before the first; runs round at 0
      words = 2u * uint32_t(in_high.z) + 2u;
    }
  }
  return best;
}
#endif
