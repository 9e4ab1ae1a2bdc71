// Included by pair_filter.cpp alone, once for each processor's code (processor.h); so it guards nothing and includes nothing. kWidth: doubles in a
// vector of the processor's; GCC takes longer ones apart, number by number where they are compared.

using Doubles = double __attribute__((vector_size(8 * kWidth)));
using Masks = std::int64_t __attribute__((vector_size(8 * kWidth)));   // all bits of a lane, or none
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));

struct Point {
  Doubles x, y, z;
};

// A corner of s or t, from a lane on. Exact.
static void load(const std::array<std::int32_t, kLanes>& from, std::size_t lane, Doubles& out) {
  Ints whole;
  std::memcpy(&whole, from.data() + lane, sizeof whole);
  out = __builtin_convertvector(whole, Doubles);
}
static void load(const Coordinates& from, std::size_t corner, std::size_t lane, Point& out) {
  load(from[3 * corner], lane, out.x);
  load(from[3 * corner + 1], lane, out.y);
  load(from[3 * corner + 2], lane, out.z);
}
static void cross(const Point& a, const Point& b, Point& out) {
  out.x = a.y * b.z - a.z * b.y;
  out.y = a.z * b.x - a.x * b.z;
  out.z = a.x * b.y - a.y * b.x;
}
static void dot(const Point& a, const Point& b, Doubles& out) { out = a.x * b.x + a.y * b.y + a.z * b.z; }
static void widen(Doubles& most, const Doubles& v) {
  const Doubles size = v < 0 ? -v : v;
  most = most < size ? size : most;
}
static void widen(Doubles& most, const Point& p) {
  widen(most, p.x);
  widen(most, p.y);
  widen(most, p.z);
}

// The sign of a number, as far as it is known: neither where it is not.
struct Side {
  Masks above, below;
};
static void side(const Doubles& v, const Doubles& error, Side& out) {
  out.above = v > error;
  out.below = v < -error;
}

// Let a0, a1, a2 be s's corners and 0, b1, b2 t's, m_i = a_i × a_{i+1}, N = b1 × b2. Then
//   side of a_i of t's plane                       S_i = N·a_i,
//   side of t's corners of s's plane               T_0 = −a0·m_1, T_1 = T_0 + Σ b1·m_i, T_2 = T_0 + Σ b2·m_i  (s's normal is Σ m_i),
//   side on which edge i of s passes edge j of t   L_i0 = b1·m_i, L_i1 = S_{i+1} − S_i + b2·m_i − b1·m_i, L_i2 = −b2·m_i.
// Errors, ε = 2^-53, every coordinate within M and exact: a component of a cross product is a difference of two products within M², so off by
// less than 4.01 ε M²; a scalar product of it with a corner adds 3 · 4.01 for that, 6 for products and 10 for sums: below 29 ε M³, and its
// size below 6 M³ (1 + 2^-50). L_i1, T_1 and T_2 add four such: 4 · 29 and (12 + 18 + 24) for the sums: below 170 ε M³. A product that is added without
// being rounded (fused) only takes errors away.
static void judge_from(const Coordinates& s, const Coordinates& t, std::size_t begin, PairFilter::Verdict* out) {
  Point a[3], b1, b2;
  for (std::size_t i = 0; i < 3; ++i) load(s, i, begin, a[i]);
  load(t, 0, begin, b1);
  load(t, 1, begin, b2);
  Doubles most{};
  for (const Point& p : a) widen(most, p);
  widen(most, b1);
  widen(most, b2);
  const Doubles error = most * most * most * kBound;

  Point normal, m[3];
  cross(b1, b2, normal);
  for (std::size_t i = 0; i < 3; ++i) cross(a[i], a[(i + 1) % 3], m[i]);
  Doubles of_a[3], by_b1[3], by_b2[3], first;
  for (std::size_t i = 0; i < 3; ++i) {
    dot(normal, a[i], of_a[i]);
    dot(b1, m[i], by_b1[i]);
    dot(b2, m[i], by_b2[i]);
  }
  dot(a[0], m[1], first);
  Side of_s[3], of_t[3];
  for (std::size_t i = 0; i < 3; ++i) side(of_a[i], error, of_s[i]);
  side(-first, error, of_t[0]);
  side(by_b1[0] + by_b1[1] + by_b1[2] - first, error, of_t[1]);
  side(by_b2[0] + by_b2[1] + by_b2[2] - first, error, of_t[2]);

  // As exact::triangles_meet: one side, or an edge whose ends are on different sides passes the other's three edges on one side.
  const Masks apart = (of_s[0].above & of_s[1].above & of_s[2].above) | (of_s[0].below & of_s[1].below & of_s[2].below) | (of_t[0].above & of_t[1].above & of_t[2].above) |
                      (of_t[0].below & of_t[1].below & of_t[2].below);
  Masks meet{}, no_edge = Masks{} - 1;   // some edge surely does; each surely does not
  Side lines[3][3];
  const auto edge = [&](const Side& from, const Side& to, const Side& x, const Side& y, const Side& z) {
    const Masks through = (from.above & to.below) | (from.below & to.above), beside = (from.above & to.above) | (from.below & to.below);
    const Masks alike = (x.above & y.above & z.above) | (x.below & y.below & z.below);
    const Masks mixed = (x.above | y.above | z.above) & (x.below | y.below | z.below);
    meet |= through & alike;
    no_edge &= beside | mixed;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    side(by_b1[i], error, lines[i][0]);
    side(of_a[(i + 1) % 3] - of_a[i] + by_b2[i] - by_b1[i], error, lines[i][1]);
    side(-by_b2[i], error, lines[i][2]);
    edge(of_s[i], of_s[(i + 1) % 3], lines[i][0], lines[i][1], lines[i][2]);
  }
  for (std::size_t j = 0; j < 3; ++j) edge(of_t[j], of_t[(j + 1) % 3], lines[0][j], lines[1][j], lines[2][j]);
  const Masks missed = apart | (no_edge & ~meet);
  for (std::size_t lane = 0; lane < kWidth; ++lane)
    out[begin + lane] = missed[lane] != 0 ? PairFilter::kApart : meet[lane] != 0 ? PairFilter::kMeet : PairFilter::kUnknown;
}

static void judge_lanes(const Coordinates& s, const Coordinates& t, PairFilter::Verdict* out) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) judge_from(s, t, begin, out);
}
