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

// Squared distances from a point to eight boxes. Bits: those that are within the limit.
static unsigned to_boxes(const TriangleTree::Boxes& boxes, const Int3& point, float limit, float* squared) {
  Words near[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Words at = Words{} + point[static_cast<int>(k)], before = load(boxes.low[k].data() + begin) - at,
                  behind = at - load(boxes.high[k].data() + begin);
      Words gap = before > behind ? before : behind;
      gap = gap > 0 ? gap : Words{};
      const Floats away = __builtin_convertvector(gap, Floats);
      sum += away * away;
    }
    std::memcpy(squared + begin, &sum, sizeof sum);
    near[begin / kWidth] = sum <= limit;
  }
  return bits_of(near);
}

// The same of boxes along axes of their own, less what rounding may add.
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
    std::memcpy(squared + begin, &sum, sizeof sum);
    near[begin / kWidth] = sum <= limit;
  }
  return bits_of(near);
}

// Squared distances from a point to eight triangles, and their slacks: by how much their roots may be too
// large. Bits: those that may be no further than `most`, and those whose distance is the height above their
// plane.
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
      const Floats x = d[0] - load(run.from[edge][0] + begin), y = d[1] - load(run.from[edge][1] + begin),
                   z = d[2] - load(run.from[edge][2] + begin);
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
    const Floats out = height * height + (outside != 0 ? least : Floats{}), reach = most + room;
    std::memcpy(squared + begin, &out, sizeof out);
    std::memcpy(slack + begin, &room, sizeof room);
    near[begin / kWidth] = out <= reach * reach * (1 + kSquareSlack);
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

// What of a run may be as near as the best so far, the nearest first: after it few others still may.
static void look_into(DepthSearch::Tables& tables, Search& search, std::uint32_t number) {
  ++tables.looks;
  const std::size_t first = kEight * number;
  const unsigned there = 0xFFU >> (kEight - std::min(kEight, tables.tree.order.size() - first));
  alignas(32) float squared[kEight], slack[kEight];
  const NearTriangles found = to_triangles(tables.run(number), search.point, search.most(), squared, slack);
  unsigned near = there & found.near;
  if (near == 0) return;
  int i = std::countr_zero(near);
  for (unsigned rest = near & (near - 1); rest != 0; rest &= rest - 1)
    if (squared[std::countr_zero(rest)] < squared[i]) i = std::countr_zero(rest);
  for (;;) {
    tables.look_at(search, static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(i),
                   (found.above >> i & 1) != 0);
    near &= ~(1U << i);
    if (near == 0) return;
    near &= within(squared, slack, search.most());
    if (near == 0) return;
    i = std::countr_zero(near);
  }
}

// From the root to runs, the nearest of each node first.
static void descend(DepthSearch::Tables& tables, Search& search, std::uint32_t guess) {
  struct Open {
    std::uint32_t level, node;
    float squared;
  };
  std::array<Open, kEight * 12>
      open;  // a level leaves at most seven nodes waiting, and 8^12 triangles are more than a mesh can have
  const std::uint32_t seen = guess == kNobody ? kNobody : guess / static_cast<std::uint32_t>(kEight);
  if (seen != kNobody) look_into(tables, search, seen);
  std::size_t count = 0;
  open[count++] = {static_cast<std::uint32_t>(tables.tree.level_begin.size()), 0,
                   0};  // level 0: a run; level n: a node of level n - 1's boxes
  alignas(32) float squared[kEight];
  while (count != 0) {
    const Open next = open[--count];
    const float most = search.most(), limit = most * most * (1 + kSquareSlack);
    if (next.squared > limit) continue;
    if (next.level == 0) {
      if (next.node != seen) look_into(tables, search, next.node);
      continue;
    }
    ++tables.looks;
    const std::uint32_t first = static_cast<std::uint32_t>(kEight) * next.node;
    const unsigned there =
        0xFFU >> (kEight - std::min<std::size_t>(kEight, tables.tree.nodes(next.level - 1) - first));
    const std::size_t group = tables.tree.level_begin[next.level - 1] + next.node;
    unsigned near = there & to_boxes(tables.tree.boxes[group], search.point, limit, squared);
    if (near != 0 && most > tables.turned_from[std::min<std::size_t>(next.level, kLevels)])
      near &= to_turned(tables.tree.turned[group], search.point, limit, squared);
    std::size_t nearest = count;
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(near));
      open[count] = {next.level - 1, first + i, squared[i]};
      if (squared[i] < open[nearest].squared) nearest = count;
      ++count;
    }
    if (nearest != count) std::swap(open[nearest], open[count - 1]);
  }
}
