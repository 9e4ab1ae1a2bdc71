// Included by depth_search.cpp alone, once for each processor's code (processor.h); so it guards nothing and
// includes nothing. kWidth: floats in a vector of the processor's.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

static Words load(const std::int32_t* from) {
  Words out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
static Floats load(const float* from) {
  Floats out;
  std::memcpy(&out, from, sizeof out);
  return out;
}
static Floats size_of(Floats a) { return a < 0 ? -a : a; }
static Floats larger(Floats a, Floats b) { return a > b ? a : b; }
static Floats smaller(Floats a, Floats b) { return a < b ? a : b; }

// A bit for each lane of eight whose word is not 0 but all bits.
static unsigned bits_of(const Words* lanes) {
#ifdef PALPATE_SIGN_BITS
  Floats signs;
  std::memcpy(&signs, lanes, sizeof signs);
  return static_cast<unsigned>(__builtin_ia32_movmskps256(signs));
#else
  std::uint64_t all = 0, pairs[4];
  std::memcpy(pairs, lanes, sizeof pairs);
  for (std::size_t i = 0; i < 4; ++i) all |= pairs[i] & (std::uint64_t{0x2'0000'0001} << 2 * i);
  return static_cast<unsigned>(all | all >> 32) & 0xFF;
#endif
}

// The first lane of eight that has the least of them.
static unsigned least_of(const float* lanes) {
  Floats least = load(lanes);
#ifdef PALPATE_SIGN_BITS
  least = smaller(least, __builtin_shufflevector(least, least, 4, 5, 6, 7, 0, 1, 2, 3));
  least = smaller(least, __builtin_shufflevector(least, least, 2, 3, 0, 1, 6, 7, 4, 5));
  least = smaller(least, __builtin_shufflevector(least, least, 1, 0, 3, 2, 5, 4, 7, 6));
#else
  least = smaller(least, load(lanes + kWidth));
  least = smaller(least, __builtin_shufflevector(least, least, 2, 3, 0, 1));
  least = smaller(least, __builtin_shufflevector(least, least, 1, 0, 3, 2));
#endif
  Words same[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth)
    same[begin / kWidth] = load(lanes + begin) == least;
  return static_cast<unsigned>(std::countr_zero(bits_of(same)));
}

constexpr float kFurther = std::numeric_limits<float>::infinity();  // of a lane that is not near

// Squared distances from a box to eight others, kFurther beyond the limit. Bits: those that are within it.
static unsigned to_boxes(const TriangleTree::Boxes& boxes, const Int3& lowest, const Int3& highest,
                         float limit, float* squared) {
  Words near[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Words before = load(boxes.low[k].data() + begin) - highest[static_cast<int>(k)],
                  behind = lowest[static_cast<int>(k)] - load(boxes.high[k].data() + begin);
      Words gap = before > behind ? before : behind;
      gap = gap > 0 ? gap : Words{};
      const Floats away = __builtin_convertvector(gap, Floats);
      sum += away * away;
    }
    near[begin / kWidth] = sum <= limit;
    sum = near[begin / kWidth] != 0 ? sum : Floats{} + kFurther;
    std::memcpy(squared + begin, &sum, sizeof sum);
  }
  return bits_of(near);
}

// The same of boxes along axes of their own, less what rounding may add, where to_boxes() has come before.
static unsigned to_turned(const TriangleTree::TurnedBoxes& boxes, const Int3& point, float limit,
                          float* squared) {
  Words near[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats d[3], sum{};
    for (std::size_t k = 0; k < 3; ++k)
      d[k] = __builtin_convertvector(
          Words{} + point[static_cast<int>(k)] - load(boxes.corner[k].data() + begin), Floats);
    const Floats room = (size_of(d[0]) + size_of(d[1]) + size_of(d[2])) * kFloatSlack;
    for (std::size_t a = 0; a < 3; ++a) {
      const Floats at = load(boxes.axis[a][0].data() + begin) * d[0] +
                        load(boxes.axis[a][1].data() + begin) * d[1] +
                        load(boxes.axis[a][2].data() + begin) * d[2];
      const Floats gap = larger(
          larger(load(boxes.low[a].data() + begin) - at, at - load(boxes.high[a].data() + begin)) - room,
          Floats{});
      sum += gap * gap;
    }
    near[begin / kWidth] = (sum <= limit) & (load(squared + begin) <= limit);
    sum = near[begin / kWidth] != 0 ? sum : Floats{} + kFurther;
    std::memcpy(squared + begin, &sum, sizeof sum);
  }
  return bits_of(near);
}

// Squared distances from a point to eight triangles, kFurther where one is further than `most`, and their
// slacks: by how much their roots may be too large. Bits: those that may be no further than `most`, and those
// whose distance is the height above their plane.
static NearTriangles to_triangles(const TriangleRun& run, const Int3& point, float most, float* squared,
                                  float* slack) {
  Words near[kEight / kWidth], above[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats d[3];
    for (std::size_t k = 0; k < 3; ++k)
      d[k] =
          __builtin_convertvector(Words{} + point[static_cast<int>(k)] - load(run.corner[k] + begin), Floats);
    const Floats room =
        (size_of(d[0]) + size_of(d[1]) + size_of(d[2])) * kFloatSlack + load(run.room + begin);
    // Of the edges that may have the point on their outer side, the nearest.
    Words outside{}, inside = Words{} - 1;
    Floats least = Floats{} + 0x1p120F;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      // The first edge begins at the first corner.
      const auto from = [&](std::size_t k) {
        return edge == 0 ? d[k] : d[k] - load(run.from[edge - 1][k] + begin);
      };
      const Floats x = from(0), y = from(1), z = from(2);
      const Floats side = load(run.out[edge][0] + begin) * x + load(run.out[edge][1] + begin) * y +
                          load(run.out[edge][2] + begin) * z;
      const Floats at = load(run.along[edge][0] + begin) * x + load(run.along[edge][1] + begin) * y +
                        load(run.along[edge][2] + begin) * z;
      const Floats over = larger(larger(-at, at - load(run.length[edge] + begin)), Floats{}),
                   away = side * side + over * over;
      outside |= side > room;
      inside &= side < -room;
      least = side < -room ? least : smaller(least, away);
    }
    const Floats height = load(run.normal[0] + begin) * d[0] + load(run.normal[1] + begin) * d[1] +
                          load(run.normal[2] + begin) * d[2];
    Floats out = height * height + (outside != 0 ? least : Floats{});
    const Floats reach = most + room;
    near[begin / kWidth] = out <= reach * reach * (1 + kSquareSlack);
    out = near[begin / kWidth] != 0 ? out : Floats{} + kFurther;
    std::memcpy(squared + begin, &out, sizeof out);
    std::memcpy(slack + begin, &room, sizeof room);
    above[begin / kWidth] = inside;
  }
  return {bits_of(near), bits_of(above)};
}

// Bits: of eight triangles those that may be no further than `most`.
static unsigned within(const float* squared, const float* slack, float most) {
  Words near[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    const Floats reach = most + load(slack + begin);
    near[begin / kWidth] = load(squared + begin) <= reach * reach * (1 + kSquareSlack);
  }
  return bits_of(near);
}

// Bits: the first `count` of eight.
static unsigned first_of(std::size_t count) { return 0xFFU >> (kEight - std::min(kEight, count)); }

// What of a run may be as near as the best so far, the nearest first: after it few others still may.
static void look_into(DepthSearch::Tables& tables, Search& search, std::uint32_t number) {
  ++tables.looks;
  const std::size_t first = kEight * number;
  const unsigned there = first_of(tables.tree.order.size() - first);
  alignas(32) float squared[kEight], slack[kEight];
  const NearTriangles found = to_triangles(tables.run(number), search.point, search.most(), squared, slack);
  unsigned near = there & found.near;
  if (near == 0) return;
  for (unsigned i = least_of(squared);;) {
    tables.look_at(search, static_cast<std::uint32_t>(first) + i, (found.above >> i & 1) != 0);
    near &= ~(1U << i);
    if (near == 0) return;
    near &= within(squared, slack, search.most());
    if (near == 0) return;
    i = static_cast<unsigned>(std::countr_zero(near));
  }
}

// Finds what a search in a cube begins with: what is as near to it as its points are deep at most. One of
// them is `depth` deep, and no other by more than the cube's diagonal deeper.
static void find_nodes(DepthSearch::Tables& tables, Cube& cube, std::int64_t depth) {
  const TriangleTree& tree = tables.tree;
  const std::int32_t edge = std::int32_t{1} << tables.cube_shift;
  const Int3 lowest = cube.place * edge, highest = lowest + (edge - 1);
  const float most = static_cast<float>(depth + kRounding) + kDiagonal * static_cast<float>(edge),
              limit = most * most * (1 + kSquareSlack);
  alignas(32) float squared[kEight];
  cube.nodes[0] = {static_cast<std::uint32_t>(tree.level_begin.size()), 0};
  cube.count = 1;
  // From the root, whose children there is always room for. The largest first; what has too many children
  // stays.
  for (std::uint32_t level = cube.nodes[0].level; level > 0; --level)
    for (std::uint32_t n = 0; n < cube.count;) {
      const Node node = cube.nodes[n];
      unsigned near = 0;
      if (node.level == level) {
        ++tables.looks;
        const std::uint32_t first = static_cast<std::uint32_t>(kEight) * node.number;
        near =
            to_boxes(tree.boxes[tree.level_begin[level - 1] + node.number], lowest, highest, limit, squared) &
            first_of(tree.nodes(level - 1) - first);
      }
      if (node.level != level ||
          cube.count - 1 + static_cast<std::uint32_t>(std::popcount(near)) > Cube::kMost) {
        ++n;
        continue;
      }
      cube.nodes[n] = cube.nodes[--cube.count];
      for (; near != 0; near &= near - 1)
        cube.nodes[cube.count++] = {level - 1, static_cast<std::uint32_t>(kEight) * node.number +
                                                   static_cast<std::uint32_t>(std::countr_zero(near))};
    }
  for (std::size_t n = 0; n < cube.count; ++n) {
    const Node node = cube.nodes[n];
    const TriangleTree::Boxes& from = tree.boxes[tree.level_begin[node.level] + node.number / kEight];
    TriangleTree::Boxes& to = cube.boxes[n / kEight];
    for (std::size_t k = 0; k < 3; ++k) {
      to.low[k][n % kEight] = from.low[k][node.number % kEight];
      to.high[k][n % kEight] = from.high[k][node.number % kEight];
    }
  }
}

// A node that is still to be looked into.
struct Open : Node {
  float squared;
};

// From what is known of the point's cube, or from the root, to runs, the nearest of each node first.
static void descend(DepthSearch::Tables& tables, Search& search, std::uint32_t guess) {
  std::array<Open, Cube::kMost + kEight * 12>
      open;  // a level leaves at most seven nodes waiting, and 8^12 triangles are more than a mesh can have
  std::size_t count = 0;
  const std::uint32_t seen = guess == kNobody ? kNobody : guess / static_cast<std::uint32_t>(kEight);
  if (seen != kNobody) look_into(tables, search, seen);
  alignas(32) float squared[kEight];
  Open next{{static_cast<std::uint32_t>(tables.tree.level_begin.size()), 0}, 0};
  const Int3 place = search.point >> tables.cube_shift;
  Cube& cube = tables.cube_at(place);
  const bool asked_before = cube.place == place;
  if (asked_before && cube.count != 0) {
    const float most = search.most(), limit = most * most * (1 + kSquareSlack);
    next.squared = kFurther;
    for (std::size_t first = 0; first < cube.count; first += kEight) {
      ++tables.looks;
      for (unsigned near = to_boxes(cube.boxes[first / kEight], search.point, search.point, limit, squared) &
                           first_of(cube.count - first);
           near != 0; near &= near - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(near));
        Open one{cube.nodes[first + i], squared[i]};
        if (one.squared < next.squared) std::swap(one, next);
        if (one.squared < kFurther) open[count++] = one;
      }
    }
  }
  // Down to the nearest child of each node without a way through memory; the others wait.
  const auto nearest_child = [&](float most, float limit) {
    ++tables.looks;
    const std::uint32_t level = next.level - 1, first = static_cast<std::uint32_t>(kEight) * next.number;
    const std::size_t group = tables.tree.level_begin[level] + next.number,
                      there = tables.tree.nodes(level) - first;
    unsigned near = to_boxes(tables.tree.boxes[group], search.point, search.point, limit, squared);
    if (near != 0 && most > tables.turned_from[std::min<std::size_t>(next.level, kLevels)])
      near = to_turned(tables.tree.turned[group], search.point, limit, squared);
    near &= first_of(there);
    if (near == 0) return false;
    unsigned nearest = least_of(squared);
    if ((near >> nearest & 1) == 0) nearest = static_cast<unsigned>(std::countr_zero(near));  // it is none
    for (unsigned rest = near & ~(1U << nearest); rest != 0; rest &= rest - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(rest));
      open[count++] = {{level, first + i}, squared[i]};
    }
    next = {{level, first + nearest}, squared[nearest]};
    return true;
  };
  for (;;) {
    const float most = search.most(), limit = most * most * (1 + kSquareSlack);
    if (next.squared <= limit) {
      if (next.level != 0) {
        if (nearest_child(most, limit)) continue;
      } else if (next.number != seen) {
        look_into(tables, search, next.number);
      }
    }
    if (count == 0) break;
    next = open[--count];
  }
  // A cube's second point pays for all that follow.
  if (!asked_before) {
    cube.place = place;
    cube.count = 0;
  } else if (cube.count == 0) {
    find_nodes(tables, cube, search.best);
  }
}
