// How deep a lattice point lies below a body's surface, looked for by one invocation alone: down the tree, the
// nearest box of a group first. llvmpipe pays much for barriers, and runs both branches of an `if`: so boxes and
// triangles have a loop each. lib/body/body_depth.glsl includes it.
#ifndef PALPATE_LIB_BODY_DEPTH_ALONE
#define PALPATE_LIB_BODY_DEPTH_ALONE

const uint32_t kKept = 8u;

// What may be the nearest. A place is free where `least` is beyond `reach`.
struct NearTriangles {
  float reach;   // what is further is not the nearest
  uint32_t above;   // bits: those whose distance is the height above their plane
  uint32_t place[kKept];
  float least[kKept];
};

NearTriangles none_near(float reach) {
  NearTriangles near;
  near.reach = reach;
  near.above = 0u;
  for (uint32_t i = 0u; i < kKept; ++i) {
    near.place[i] = kNone;
    near.least[i] = 2.0 * kFar;
  }
  return near;
}

// Keeps a triangle if it may be the nearest. False: there is no room.
bool keep_near(uint32_t place, DistanceBounds bounds, inout NearTriangles near) {
  near.reach = min(near.reach, bounds.most);
  uint32_t free = kKept;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.least[i] > near.reach) free = i;
  if (bounds.least > near.reach) return true;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (i == free) {
      near.place[i] = place;
      near.least[i] = bounds.least;
      near.above = near.above & ~(1u << i) | uint32_t(bounds.above) << i;
    }
  return free != kKept;
}

// Bits: of those that are kept the ones that still may be the nearest.
uint32_t open_of(NearTriangles near) {
  uint32_t open = 0u;
  for (uint32_t i = 0u; i < kKept; ++i)
    if (near.least[i] <= near.reach) open |= 1u << i;
  return open;
}

void come_nearer(Depth best, inout NearTriangles near) {
  near.reach = min(near.reach, float(best.steps) + float(2 * kDepthSlack));
}

// Integers on what has been kept: first where they are soon done, and mostly nothing else is left then.
void decide_kept(ivec3 p, uvec4 head, inout NearTriangles near, inout Depth best) {
  uint32_t open = open_of(near) & near.above;
  while (open != 0u && !spent(1u)) {
    const uint32_t place = near.place[findLSB(open)];
    const Placed t = triangle_at(head.w, place);
    take_nearest(height_above(t.normal, t.a, p), head, place, best);
    open &= open - 1u;
  }
  come_nearer(best, near);
  open = open_of(near) & ~near.above;
  while (open != 0u && !spent(1u)) {
    decide_nearest(p, head, near.place[findLSB(open)], best);
    come_nearer(best, near);
    open &= open - 1u;
    open &= open_of(near);
  }
  near = none_near(near.reach);
}

// Of the boxes of a group the nearest one, and bits: of those of `left` that may hold something within the reach.
uint32_t near_boxes(uint32_t at, uint32_t left, float reach, ivec3 p, out uint32_t nearest) {
  vec4 squares[2] = {vec4(0.0), vec4(0.0)};
  for (uint32_t k = 0u; k < 3u; ++k)
    for (uint32_t four = 0u; four < 2u; ++four) {
      const ivec4 low = ivec4(tree_texel(at + 2u * k + four)), high = ivec4(tree_texel(at + 6u + 2u * k + four));
      const vec4 gap = vec4(max(max(low - p[k], p[k] - high), ivec4(0)));
      squares[four] += gap * gap;
    }
  const float limit = square_of(reach);
  float least = 2.0 * kFar * kFar;
  uint32_t bits = 0u;
  nearest = 0u;
  for (uint32_t i = 0u; i < 8u; ++i) {
    const float square = squares[i / 4u][i % 4u];
    const bool may = square <= limit && (left >> i & 1u) != 0u;
    bits |= uint32_t(may) << i;
    if (may && square < least) {
      least = square;
      nearest = i;
    }
  }
  return bits;
}

uvec3 bits_of_level(uint32_t level, uint32_t bits) {
  const uint32_t word = bits << 8u * (level % 4u);
  return uvec3(level < 4u ? word : 0u, level / 4u == 1u ? word : 0u, level < 8u ? 0u : word);
}

Depth depth_alone(ivec3 p) {
  const uvec4 head = tree_texel(0u);
  Depth best = kNoDepth;
  NearTriangles near = none_near(kFar);
  // By level eight bits: boxes of the group on the way down that are left to look into. The group of the lowest
  // level that has any is number `node`.
  uvec3 left = uvec3(0u);
  uint32_t level = head.y - 1u, node = 0u;
  bool more = head.y != 0u;
  if (more) left |= bits_of_level(level, 0xFFu);
  uint32_t place = 0u, last = 0u;   // of the present run
  while ((more || place < last) && !spent(1u)) {
    bool room = true;
    while (room && (more || place < last) && !spent(1u)) {
      while (more && place == last && !spent(1u)) {
        more = left != uvec3(0u);
        if (!more) break;
        const uint32_t lowest = left.x != 0u   ? uint32_t(findLSB(left.x))
                                : left.y != 0u ? 32u + uint32_t(findLSB(left.y))
                                               : 64u + uint32_t(findLSB(left.z));
        node >>= 3u * (lowest / 8u - level);
        level = lowest / 8u;
        const uvec4 boxes = tree_texel(kTreeLevel + level);
        const uint32_t left_of_level = level < 4u ? left.x : level < 8u ? left.y : left.z,
                       there = 0xFFu >> (8u - min(8u, boxes.y - 8u * node));
        uint32_t nearest;
        const uint32_t bits =
            near_boxes(boxes.x + kTreeGroupTexels * node, left_of_level >> 8u * (level % 4u) & there, near.reach, p,
                       nearest);
        left = left & ~bits_of_level(level, 0xFFu) | bits_of_level(level, bits & ~(1u << nearest));
        if (bits == 0u) continue;
        const uint32_t child = 8u * node + nearest;
        if (level == 0u) {
          place = 8u * child;
          last = min(place + 8u, head.x);
        } else {
          --level;
          node = child;
          left |= bits_of_level(level, 0xFFu);
        }
      }
      while (room && place < last && !spent(1u)) {
        room = keep_near(place, bounds_at(head.w, place, p), near);
        if (room) ++place;
      }
    }
    decide_kept(p, head, near, best);
  }
  return best;
}
#endif
