// Included by pair_filter.cpp alone, once for each processor's code (processor.h); so it guards nothing and
// includes nothing. kWidth: floats in a vector of the processor's; GCC takes longer ones apart, number by
// number where they are compared.

using Floats = float __attribute__((vector_size(4 * kWidth)));
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));  // as masks: all bits of a lane, or none

struct Point {
  Floats x, y, z;
};

// Coordinate by coordinate.
struct Whole {
  Words at[3];
};
static void load(const Coordinates& from, std::size_t corner, std::size_t lane, Whole& out) {
  for (std::size_t k = 0; k < 3; ++k)
    std::memcpy(&out.at[k], from[3 * corner + k].data() + lane, sizeof out.at[k]);
}
static void between(const Whole& from, const Whole& to, Whole& out) {
  for (std::size_t k = 0; k < 3; ++k) out.at[k] = to.at[k] - from.at[k];
}
// To 24 bits.
static void round(const Whole& p, Point& out) {
  out = {__builtin_convertvector(p.at[0], Floats), __builtin_convertvector(p.at[1], Floats),
         __builtin_convertvector(p.at[2], Floats)};
}
// `most` becomes the largest size of a coordinate, if it is larger.
static void widen(Floats& most, const Point& p) {
  for (const Floats& v : {p.x, p.y, p.z}) {
    const Floats size = v < 0 ? -v : v;
    most = most < size ? size : most;
  }
}
static void cross(const Point& a, const Point& b, Point& out) {
  out.x = a.y * b.z - a.z * b.y;
  out.y = a.z * b.x - a.x * b.z;
  out.z = a.x * b.y - a.y * b.x;
}
static void dot(const Point& a, const Point& b, Floats& out) { out = a.x * b.x + a.y * b.y + a.z * b.z; }

// The sign of a number, as far as it is known: neither where it is not.
struct Side {
  Words above, below;
};
static void side(const Floats& v, const Floats& error, Side& out) {
  out.above = v > error;
  out.below = v < -error;
}

// Let a0, a1, a2 be s's corners and 0, b1, b2 t's, e_i = a_{i+1} − a_i, f = b2 − b1, m_i = a_i × e_i, N = b1
// × b2, n = e_0 × e_1. Then
//   side of a_i of t's plane                       S_i = N·a_i,
//   side of t's corners of s's plane               T_0 = −n·a0, T_1 = T_0 + n·b1, T_2 = T_0 + n·b2,
//   side on which edge i of s passes edge j of t   L_i0 = b1·m_i, L_i1 = N·e_i + f·m_i, L_i2 = −b2·m_i.
// Differences are exact integers. Errors, u = 2^-24, components within A, B (of b1 and b2; f within 2 B) and
// E: each is off by u times itself before it is multiplied. A component of a cross product is a difference of
// two products of such, so off by less than 2 · 3 + 2 = 8 u times both sizes and itself within twice these; a
// scalar product of it with a third vector by 3 · (8 + 2 · 2) for its terms and 4 + 6 for sums: 46 u times
// three sizes, itself within six times these. So
//   S_i, 46 u A B²;   T_1 and T_2, u E² (46 (A + B) + 6 (A + B));
//   L_i1, u B E (46 B + 2 · 46 A + 6 B + 12 A).
// Second orders are below 2^-18 of that. A product that is added without being rounded (fused) only takes
// errors away.
static void judge_from(const Coordinates& s, const Coordinates& t, std::size_t begin,
                       PairFilter::Verdict* out) {
  Point a[3], e[3], b1, b2, f;
  Floats most_a{}, most_b{}, most_e{};
  {
    Whole whole[3], way, t1, t2;
    for (std::size_t i = 0; i < 3; ++i) load(s, i, begin, whole[i]);
    for (std::size_t i = 0; i < 3; ++i) {
      between(whole[i], whole[(i + 1) % 3], way);
      round(whole[i], a[i]);
      round(way, e[i]);
      widen(most_a, a[i]);
      widen(most_e, e[i]);
    }
    load(t, 0, begin, t1);
    load(t, 1, begin, t2);
    between(t1, t2, way);
    round(t1, b1);
    round(t2, b2);
    round(way, f);
    widen(most_b, b1);
    widen(most_b, b2);
  }
  const Floats reach = (most_a + most_b) * kBound, error_s = most_b * most_b * reach,
               error_t = most_e * most_e * reach, error_l = most_b * most_e * reach;

  Point of_t, of_s, m;
  cross(b1, b2, of_t);
  cross(e[0], e[1], of_s);
  Floats at_s[3], at_t[3], first, along;
  for (std::size_t i = 0; i < 3; ++i) dot(of_t, a[i], at_s[i]);
  dot(of_s, a[0], first);
  at_t[0] = -first;
  dot(of_s, b1, along);
  at_t[1] = along - first;
  dot(of_s, b2, along);
  at_t[2] = along - first;
  Side ends_s[3], ends_t[3];
  for (std::size_t i = 0; i < 3; ++i) {
    side(at_s[i], error_s, ends_s[i]);
    side(at_t[i], error_t, ends_t[i]);
  }

  // As exact::triangles_meet: one side, or an edge whose ends are on different sides passes the other's three
  // edges on one side.
  const Words apart = (ends_s[0].above & ends_s[1].above & ends_s[2].above) |
                      (ends_s[0].below & ends_s[1].below & ends_s[2].below) |
                      (ends_t[0].above & ends_t[1].above & ends_t[2].above) |
                      (ends_t[0].below & ends_t[1].below & ends_t[2].below);
  Words meet{}, no_edge = Words{} - 1;  // some edge surely does; each surely does not
  Side lines[3][3];
  const auto edge = [&](const Side& from, const Side& to, const Side& x, const Side& y, const Side& z) {
    const Words through = (from.above & to.below) | (from.below & to.above),
                beside = (from.above & to.above) | (from.below & to.below);
    const Words alike = (x.above & y.above & z.above) | (x.below & y.below & z.below);
    const Words mixed = (x.above | y.above | z.above) & (x.below | y.below | z.below);
    meet |= through & alike;
    no_edge &= beside | mixed;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    cross(a[i], e[i], m);
    Floats by_b1, by_b2, by_f, by_e;
    dot(b1, m, by_b1);
    dot(b2, m, by_b2);
    dot(f, m, by_f);
    dot(of_t, e[i], by_e);
    side(by_b1, error_l, lines[i][0]);
    side(by_e + by_f, error_l, lines[i][1]);
    side(-by_b2, error_l, lines[i][2]);
    edge(ends_s[i], ends_s[(i + 1) % 3], lines[i][0], lines[i][1], lines[i][2]);
  }
  for (std::size_t j = 0; j < 3; ++j)
    edge(ends_t[j], ends_t[(j + 1) % 3], lines[0][j], lines[1][j], lines[2][j]);
  const Words missed = apart | (no_edge & ~meet);
  for (std::size_t lane = 0; lane < kWidth; ++lane)
    out[begin + lane] = missed[lane] != 0 ? PairFilter::kApart
                        : meet[lane] != 0 ? PairFilter::kMeet
                                          : PairFilter::kUnknown;
}

static void judge_lanes(const Coordinates& s, const Coordinates& t, PairFilter::Verdict* out) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) judge_from(s, t, begin, out);
}
