// Included by depth_search.cpp alone, once for each processor's code (processor.h); so it guards nothing and includes nothing. kWidth: floats in a
// vector of the processor's.

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
  std::uint64_t all = 0, pairs[4];
  std::memcpy(pairs, lanes, sizeof pairs);
  for (std::size_t i = 0; i < 4; ++i) all |= pairs[i] & (std::uint64_t{0x2'0000'0001} << 2 * i);
  return static_cast<unsigned>(all | all >> 32) & 0xFF;
}

// Squared distances from a point to eight boxes. Bits: those that are within the limit.
static unsigned to_boxes(const TriangleTree::Boxes& boxes, const Int3& point, float limit, float* squared) {
  Words near[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Words at = Words{} + point[static_cast<int>(k)], before = load(boxes.low[k].data() + begin) - at, behind = at - load(boxes.high[k].data() + begin);
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

// Squared distances from a point to eight triangles, and their slacks: by how much their roots may be too large. Bits: those that may be no further than `most`, and those
// whose distance is the height above their plane.
static NearTriangles to_triangles(const TriangleRun& run, const Int3& point, float most, float* squared, float* slack) {
  Words near[kEight / kWidth], above[kEight / kWidth];
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) {
    Floats d[3];
    for (std::size_t k = 0; k < 3; ++k) d[k] = __builtin_convertvector(Words{} + point[static_cast<int>(k)] - load(run.corner[k] + begin), Floats);
    const Floats room = (size_of(d[0]) + size_of(d[1]) + size_of(d[2])) * kFloatSlack + load(run.room + begin);
    // Of the edges that may have the point on their outer side, the nearest.
    Words outside{}, inside = Words{} - 1;
    Floats least = Floats{} + 0x1p120F;
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const Floats x = d[0] - load(run.from[edge][0] + begin), y = d[1] - load(run.from[edge][1] + begin), z = d[2] - load(run.from[edge][2] + begin);
      const Floats side = load(run.out[edge][0] + begin) * x + load(run.out[edge][1] + begin) * y + load(run.out[edge][2] + begin) * z;
      const Floats at = load(run.along[edge][0] + begin) * x + load(run.along[edge][1] + begin) * y + load(run.along[edge][2] + begin) * z;
      const Floats over = larger(larger(-at, at - load(run.length[edge] + begin)), Floats{}), away = side * side + over * over;
      outside |= side > room;
      inside &= side < -room;
      least = side < -room ? least : smaller(least, away);
    }
    const Floats height = load(run.normal[0] + begin) * d[0] + load(run.normal[1] + begin) * d[1] + load(run.normal[2] + begin) * d[2];
    const Floats out = height * height + (outside != 0 ? least : Floats{}), reach = most + room;
    std::memcpy(squared + begin, &out, sizeof out);
    std::memcpy(slack + begin, &room, sizeof room);
    near[begin / kWidth] = out <= reach * reach * (1 + kSquareSlack);
    above[begin / kWidth] = inside;
  }
  return {bits_of(near), bits_of(above)};
}
