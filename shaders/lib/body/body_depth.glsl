// How deep a lattice point lies below the surface of a body that does not move, in its own frame
// (docs/EXACTNESS.md section 4, "Depth"), exact. LANES invocations go down the body's tree together, eight
// boxes or triangles of a node at a time. Floats say which triangles may be the nearest; integers decide among
// those few at the end.
// The including shader has TEXELS body_tree (shared/scene.h) and frame_state (writable).
#ifndef PALPATE_LIB_BODY_DEPTH
#define PALPATE_LIB_BODY_DEPTH
#include "shaders/shared/frame_field.h"
#include "shaders/lib/budget.glsl"
#include "shaders/lib/team.glsl"
#include "shaders/lib/distance.glsl"
#include "shaders/lib/distance_estimate.glsl"

struct Depth {
  int32_t steps;       // φ
  uint32_t triangle;   // the nearest one, of several the smallest id; kNone: there is none
};

const Depth kNoDepth = Depth(0x7FFFFFFF, kNone);
const float kFar = 4294967296.0;   // beyond every distance

// What is open of a search: a level of boxes << kLevelShift | a node of eight of them, or a run.
const uint32_t kLevelShift = 28u, kNodeBits = (1u << kLevelShift) - 1u, kRun = 15u << kLevelShift;

// By team of LANES invocations that look for a point's depth together. Of a team: the nodes left to look into,
// the last ones first, each with the square of its distance (a float's bits); triangles that may be the
// nearest, with their least distance (likewise); and how far the nearest one is at most.
const uint32_t kOpenRoom = 12u * LANES, kKeptRoom = 4u * LANES;
shared uint32_t open_nodes[12u * kGroupSize], open_squares[12u * kGroupSize];
shared uint32_t kept_triangles[4u * kGroupSize];
shared int32_t kept_least[4u * kGroupSize];
shared uint32_t open_count[kGroupSize], kept_count[kGroupSize], team_reach[kGroupSize];
shared uint32_t team_nearest[kGroupSize];
shared int32_t team_steps[kGroupSize];
shared uint32_t gave_up;

uvec4 tree_texel(uint32_t at) { return body_tree(at); }

// A box that is so far away along each axis: a triangle in it is no nearer than the square's root less
// kDepthSlack, and in `most` how far one of it is at most.
float square_to_box(ivec3 p, ivec3 low, ivec3 high, out float most) {
  const vec3 gap = vec3(max(max(low - p, p - high), ivec3(0))), far = vec3(max(abs(p - low), abs(high - p)));
  most = sqrt(far.x * far.x + far.y * far.y + far.z * far.z) * (1.0 + 1.0 / 262144.0) + float(kDepthSlack);
  return gap.x * gap.x + gap.y * gap.y + gap.z * gap.z;
}

// The square within which a box must lie.
float square_of(float reach) {
  const float most = reach + float(kDepthSlack);
  return most * most * (1.0 + 1.0 / 262144.0);
}

// A triangle by its place in the tree's order.
struct Placed {
  ivec3 a, b, c, normal;
};

Placed triangle_at(uint32_t records, uint32_t place) {
  const uint32_t at = records + kTreeRecordTexels * place;
  const ivec4 a = ivec4(tree_texel(at)), b = ivec4(tree_texel(at + 1u)), c = ivec4(tree_texel(at + 2u));
  return Placed(a.xyz, b.xyz, c.xyz, ivec3(a.w, b.w, c.w));
}

DistanceBounds bounds_at(uint32_t records, uint32_t place, ivec3 p) {
  const Placed t = triangle_at(records, place);
  return distance_bounds(t.a, t.b, t.c, t.normal, p);
}

// Box number i of a level.
void box_of(uint32_t level, uint32_t i, out ivec3 low, out ivec3 high) {
  const uint32_t at = tree_texel(kTreeLevel + level).x + kTreeGroupTexels * (i / 8u) + i / 4u % 2u;
  for (uint32_t k = 0u; k < 3u; ++k) {
    low[k] = int32_t(tree_texel(at + 2u * k)[i % 4u]);
    high[k] = int32_t(tree_texel(at + 6u + 2u * k)[i % 4u]);
  }
}

// Integers on one of those that have been kept.
void take_nearest(int32_t steps, uvec4 head, uint32_t place, inout Depth best) {
  const uint32_t id = tree_texel(head.z + place / 4u)[place % 4u];
  if (steps < best.steps || (steps == best.steps && id < best.triangle)) best = Depth(steps, id);
}

void decide_nearest(ivec3 p, uvec4 head, uint32_t place, inout Depth best) {
  const Placed t = triangle_at(head.w, place);
  take_nearest(distance_at(height_above(t.normal, t.a, p), t.normal, t.a, t.b, t.c, p), head, place, best);
}

// Looks into the team's last open nodes, an invocation a box or a triangle. Of the whole workgroup.
void look_into(uint32_t mine, uint32_t part, uvec4 head, ivec3 p) {
  const uint32_t open = open_count[mine], first = kOpenRoom * mine;
  // One node leaves at most seven more than there were on each of its levels; several at a time need more room.
  const uint32_t taken = min(open, open + 8u * LANES <= kOpenRoom ? LANES / 8u : 1u);
  uint32_t node = kNone;
  if (part / 8u < taken) {
    const uint32_t at = first + open - 1u - part / 8u;
    if (uintBitsToFloat(open_squares[at]) <= square_of(uintBitsToFloat(team_reach[mine])))
      node = open_nodes[at];
  }
  barrier();
  if (part == 0u) open_count[mine] = open - taken;
  uint32_t below = kNone, triangle = kNone;   // `triangle`: its place
  float square = 0.0, least = 0.0, most;
  if (node != kNone) {
    const uint32_t child = 8u * (node & kNodeBits) + part % 8u;
    if (node >= kRun) {
      if (child < head.x) {
        triangle = child;
        const DistanceBounds bounds = bounds_at(head.w, child, p);
        least = bounds.least;
        atomicMin(team_reach[mine], floatBitsToUint(bounds.most));
      }
    } else {
      const uint32_t level = node >> kLevelShift;
      if (child < tree_texel(kTreeLevel + level).y) {
        ivec3 low, high;
        box_of(level, child, low, high);
        square = square_to_box(p, low, high, most);
        atomicMin(team_reach[mine], floatBitsToUint(most));
        below = level == 0u ? kRun | child : (level - 1u) << kLevelShift | child;
      }
    }
  }
  barrier();
  const float reach = uintBitsToFloat(team_reach[mine]);
  if (below != kNone && square <= square_of(reach)) {
    const uint32_t at = first + atomicAdd(open_count[mine], 1u);
    open_nodes[at] = below;
    open_squares[at] = floatBitsToUint(square);
  }
  if (triangle != kNone && least <= reach) {
    const uint32_t at = kKeptRoom * mine + atomicAdd(kept_count[mine], 1u);
    kept_triangles[at] = triangle;
    kept_least[at] = floatBitsToInt(least);
  }
}

#include "shaders/lib/body/body_depth_alone.glsl"

// Of the whole workgroup, LANES invocations that follow each other with the same point, and `asks` false where
// they have none.
Depth body_depth(bool asks, ivec3 p) {
  if (LANES == 1u) return asks ? depth_alone(p) : kNoDepth;
  const uint32_t mine = team(), part = team_part();
  // The lowest level that they can look into at once.
  const uvec4 head = tree_texel(0u);
  const uint32_t levels = asks ? head.y : 0u;
  uint32_t level = levels - 1u, nodes = 0u;
  if (levels != 0u) {
    while (level > 0u && tree_texel(kTreeLevel + level - 1u).y <= LANES) --level;
    nodes = (tree_texel(kTreeLevel + level).y + 7u) / 8u;
  }
  if (part < nodes) {
    open_nodes[kOpenRoom * mine + part] = level << kLevelShift | part;
    open_squares[kOpenRoom * mine + part] = 0u;
  }
  if (part == 0u) {
    open_count[mine] = nodes;
    kept_count[mine] = 0u;
    team_reach[mine] = floatBitsToUint(kFar);
    team_steps[mine] = kNoDepth.steps;
    team_nearest[mine] = kNone;
  }
  if (gl_LocalInvocationIndex == 0u) gave_up = 0u;
  Depth best = kNoDepth;
  bool more = true;
  while (more) {
    if (spent(2u)) gave_up = 1u;
    barrier();
    bool open = false, full = false;
    for (uint32_t t = 0u; t < kTeams; ++t) {
      open = open || open_count[t] != 0u;
      full = full || kept_count[t] + LANES > kKeptRoom;
    }
    more = open && gave_up == 0u;
    if (more && !full) {
      look_into(mine, part, head, p);
    } else {
      const float reach = uintBitsToFloat(team_reach[mine]);
      for (uint32_t i = part; i < kept_count[mine] && !spent(1u); i += LANES)
        if (intBitsToFloat(kept_least[kKeptRoom * mine + i]) <= reach)
          decide_nearest(p, head, kept_triangles[kKeptRoom * mine + i], best);
      barrier();
      if (best.triangle != kNone)
        atomicMin(team_reach[mine], floatBitsToUint(float(best.steps) + float(2 * kDepthSlack)));
      if (part == 0u) kept_count[mine] = 0u;
    }
  }
  atomicMin(team_steps[mine], best.steps);
  barrier();
  if (best.steps == team_steps[mine]) atomicMin(team_nearest[mine], best.triangle);
  barrier();
  return Depth(team_steps[mine], team_nearest[mine]);
}
#endif
