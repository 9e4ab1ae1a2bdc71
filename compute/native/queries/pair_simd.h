// Included by pair_distance.cpp alone, once for each processor's code (compute/native/processor.h); so it
// guards nothing and includes nothing. kWidth: doubles in a vector of the processor's.

using Doubles = double __attribute__((vector_size(8 * kWidth)));
using Ints = std::int32_t __attribute__((vector_size(4 * kWidth)));
using Masks = std::int64_t __attribute__((vector_size(8 * kWidth)));

struct Point {
  Doubles x, y, z;
};

static void set(Doubles& out, double v) { out = Doubles{} + v; }
static void minus(const Point& a, const Point& b, Point& out) { out = {a.x - b.x, a.y - b.y, a.z - b.z}; }
static void dot(const Point& a, const Point& b, Doubles& out) { out = a.x * b.x + a.y * b.y + a.z * b.z; }
static void cross(const Point& a, const Point& b, Point& out) {
  out.x = a.y * b.z - a.z * b.y;
  out.y = a.z * b.x - a.x * b.z;
  out.z = a.x * b.y - a.y * b.x;
}
static void least(Doubles& best, const Doubles& v) { best = v < best ? v : best; }
static void most(Doubles& best, const Doubles& v) { best = v > best ? v : best; }
// What is nearest so far, and which feature (nearest_points.h).
struct Nearest {
  Doubles squared, feature;
  void take(const Masks& sooner, const Doubles& v, std::size_t number) {
    squared = sooner ? v : squared;
    feature = sooner ? Doubles{} + static_cast<double>(number) : feature;
  }
};
static void clamp01(Doubles& v) {
  const Doubles zero{}, one = zero + 1.0;
  v = v > zero ? v : zero;
  v = v < one ? v : one;
}

// A corner above a face, feature `number`: `from` is the corner relative to the face's first, normal and
// inward normals of the face's edges are given.
static void above(const Point& corner, const Point face[3], const Point& normal, const Doubles& size2,
                  const Point inward[3], std::size_t number, Nearest& best) {
  Point from;
  Doubles height, side;
  minus(corner, face[0], from);
  dot(normal, from, height);
  Masks within = size2 > Doubles{};
  for (std::size_t e = 0; e < 3; ++e) {
    minus(corner, face[e], from);
    dot(inward[e], from, side);
    within &= side >= Doubles{};
  }
  const Doubles squared = height * height / size2;
  best.take(within & (squared < best.squared), squared, number);
}

// The corners relative to the one's first.
static void corners_of(const PairLanes& in, std::size_t begin, Point a[3], Point b[3]) {
  for (std::size_t c = 0; c < 3; ++c) {
    Ints whole[3];
    for (std::size_t k = 0; k < 3; ++k) {
      std::memcpy(&whole[k], (*in.s)[3 * c + k].data() + begin, sizeof whole[k]);
      whole[k] -= in.origin[k];
    }
    a[c] = {__builtin_convertvector(whole[0], Doubles), __builtin_convertvector(whole[1], Doubles),
            __builtin_convertvector(whole[2], Doubles)};
    set(b[c].x, in.t[c][0]);
    set(b[c].y, in.t[c][1]);
    set(b[c].z, in.t[c][2]);
  }
}

// Raises `room` to what lies between the two along a direction, however long that is.
static void widen(const Point a[3], const Point b[3], const Point& way, Doubles& room) {
  Doubles of_a[3], of_b[3], size;
  for (std::size_t c = 0; c < 3; ++c) {
    dot(way, a[c], of_a[c]);
    dot(way, b[c], of_b[c]);
  }
  Doubles low_a = of_a[0], high_a = of_a[0], low_b = of_b[0], high_b = of_b[0];
  for (std::size_t c = 1; c < 3; ++c) {
    least(low_a, of_a[c]);
    least(low_b, of_b[c]);
    most(high_a, of_a[c]);
    most(high_b, of_b[c]);
  }
  dot(way, way, size);
  const Doubles ahead = low_a - high_b, behind = low_b - high_a;
  Doubles between = ahead > behind ? ahead : behind;
  const Doubles zero{};
  between = between > zero ? between : zero;
  const Doubles squared = between * between / size;
  room = squared > room ? squared : room;  // of no direction: not a number, and left out
}

// Squares of what lies between the two along the normals of both.
static void rooms_from(const PairLanes& in, std::size_t begin, std::array<double, kLanes>& out) {
  Point a[3], b[3], e, f, normal;
  corners_of(in, begin, a, b);
  Doubles room{};
  minus(b[1], b[0], e);
  minus(b[2], b[0], f);
  cross(e, f, normal);
  widen(a, b, normal, room);
  minus(a[1], a[0], e);
  minus(a[2], a[0], f);
  cross(e, f, normal);
  widen(a, b, normal, room);
  std::memcpy(out.data() + begin, &room, sizeof room);
}
static void room_lanes(const PairLanes& in, std::array<double, kLanes>& out) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) rooms_from(in, begin, out);
}

// A bit for each of the eight that the one may meet within the motion's time, as far as the eight's normals
// tell: it may lie wholly before or behind for all of it. Normals are as long as twice the triangle's area.
static unsigned may_meet_from(const PairLanes& in, std::size_t begin, const PairMotion& motion) {
  Point a[3], b[3], e, f, normal;
  corners_of(in, begin, a, b);
  minus(a[1], a[0], e);
  minus(a[2], a[0], f);
  cross(e, f, normal);
  Doubles size, own[3], other[3], along[3];
  dot(normal, normal, size);
  for (std::size_t l = 0; l < kWidth; ++l) size[l] = std::sqrt(size[l]);
  for (std::size_t c = 0; c < 3; ++c) {
    Point from, speed;
    minus(a[c], a[0], from);  // of a sliver the normal is rough
    dot(normal, from, own[c]);
    minus(b[c], a[0], from);
    dot(normal, from, other[c]);
    set(speed.x, motion.speeds[c][0]);
    set(speed.y, motion.speeds[c][1]);
    set(speed.z, motion.speeds[c][2]);
    dot(normal, speed, along[c]);
  }
  Doubles own_low = own[0], own_high = own[0], low = other[0], high = other[0], slowest = along[0],
          fastest = along[0];
  for (std::size_t c = 1; c < 3; ++c) {
    least(own_low, own[c]);
    most(own_high, own[c]);
    least(low, other[c]);
    most(high, other[c]);
    least(slowest, along[c]);
    most(fastest, along[c]);
  }
  const Doubles before = low - own_high, behind = own_low - high, zero{};
  const Doubles towards = before > behind ? -slowest : fastest;
  Doubles gets = towards * motion.time + size * motion.turns;
  gets = gets > zero ? gets : zero;
  const Masks meets = gets >= (before > behind ? before : behind) - size * motion.slack;
  unsigned out = 0;
  for (std::size_t l = 0; l < kWidth; ++l) out |= (meets[l] != 0 ? 1U : 0U) << (begin + l);
  return out;
}
static unsigned may_meet_lanes(const PairLanes& in, const PairMotion& motion) {
  unsigned out = 0;
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) out |= may_meet_from(in, begin, motion);
  return out;
}

static void judge_from(const PairLanes& in, std::size_t begin, PairDistances& out) {
  Point a[3], e[3], b[3], f[3], normal_s, normal_t, inward_s[3], inward_t[3];
  Doubles ee[3], ff[3], per_e[3], per_f[3], size_s, size_t_;
  const Doubles zero{}, one = zero + 1.0;
  corners_of(in, begin, a, b);
  for (std::size_t c = 0; c < 3; ++c) {
    minus(a[(c + 1) % 3], a[c], e[c]);
    minus(b[(c + 1) % 3], b[c], f[c]);
    dot(e[c], e[c], ee[c]);
    dot(f[c], f[c], ff[c]);
    per_e[c] = one / ee[c];
    per_f[c] = one / ff[c];
  }
  cross(e[0], e[1], normal_s);
  cross(f[0], f[1], normal_t);
  dot(normal_s, normal_s, size_s);
  dot(normal_t, normal_t, size_t_);
  for (std::size_t c = 0; c < 3; ++c) {
    cross(normal_s, e[c], inward_s[c]);
    cross(normal_t, f[c], inward_t[c]);
  }
  Nearest best{};
  set(best.squared, 1e300);
  for (std::size_t c = 0; c < 3; ++c) {
    above(a[c], b, normal_t, size_t_, inward_t, 2 * c, best);
    above(b[c], a, normal_s, size_s, inward_s, 2 * c + 1, best);
  }
  // Every edge with every other, ends included: the best place on one for the place on the other, once more
  // the other way round.
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      Point r, way;
      Doubles c, d, g;
      minus(a[i], b[j], r);
      dot(e[i], r, c);
      dot(f[j], r, g);
      dot(e[i], f[j], d);
      const Doubles under = ee[i] * ff[j] - d * d;
      Doubles s = (d * g - c * ff[j]) / under;
      s = under > zero ? s : zero;
      clamp01(s);
      Doubles t = (d * s + g) * per_f[j];
      clamp01(t);
      s = (d * t - c) * per_e[i];
      clamp01(s);
      way.x = r.x + s * e[i].x - t * f[j].x;
      way.y = r.y + s * e[i].y - t * f[j].y;
      way.z = r.z + s * e[i].z - t * f[j].z;
      Doubles squared;
      dot(way, way, squared);
      best.take(squared < best.squared, squared, 6 + 3 * i + j);
    }
  std::memcpy(out.squared.data() + begin, &best.squared, sizeof best.squared);
  std::memcpy(out.feature.data() + begin, &best.feature, sizeof best.feature);
}

static void judge_lanes(const PairLanes& in, PairDistances& out) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) judge_from(in, begin, out);
}

static void load(const std::int32_t* from, Doubles& out) {
  Ints whole;
  std::memcpy(&whole, from, sizeof whole);
  out = __builtin_convertvector(whole, Doubles);
}

// Squared gaps between a box and eight others.
template <class Number>
static void gaps_between(const double* low, const double* high, const Number* lows, const Number* highs,
                         double* out) {
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) {
    Doubles sum{};
    for (std::size_t k = 0; k < 3; ++k) {
      Doubles l, h, gap{};
      load(lows + kLanes * k + begin, l);
      load(highs + kLanes * k + begin, h);
      const Doubles ahead = l - high[k], behind = low[k] - h;
      gap = ahead > gap ? ahead : gap;
      gap = behind > gap ? behind : gap;
      sum += gap * gap;
    }
    std::memcpy(out + begin, &sum, sizeof sum);
  }
}

static void load(const float* from, Doubles& out) {
  float single __attribute__((vector_size(4 * kWidth)));
  std::memcpy(&single, from, sizeof single);
  out = __builtin_convertvector(single, Doubles);
}

// Squared gaps along the axes of eight boxes, or along the triangle's normal where that is more. Axes are
// floats, so each gap is taken shorter by 2^-20 of itself and a step, along the normal by 2^-20 of the box's
// ends instead, and the square by 2^-20, which is more than they are off (docs/EXACTNESS.md, section 9).
static void turned_gaps(const std::array<double, 9>& corners, const TriangleTree::TurnedBoxes& boxes,
                        std::array<double, kLanes>& squared) {
  double e[3], f[3], normal[3], size = 0, top = 0, bottom = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = corners[3 + k] - corners[k];
    f[k] = corners[6 + k] - corners[k];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    normal[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
    size += normal[k] * normal[k];
  }
  for (double& n : normal) n *= size > 0 ? 1 / std::sqrt(size) : 0;
  for (const auto& edge : {e, f}) {  // of a sliver the normal is rough
    const double height = normal[0] * edge[0] + normal[1] * edge[1] + normal[2] * edge[2];
    top = height > top ? height : top;
    bottom = height < bottom ? height : bottom;
  }
  for (std::size_t begin = 0; begin < kLanes; begin += kWidth) {
    const Doubles none{};
    Doubles from[3][3], sum{}, lowest{}, highest{}, ends{};  // of the box above the triangle's first corner
    for (std::size_t k = 0; k < 3; ++k) {
      Doubles corner;
      load(boxes.corner[k].data() + begin, corner);
      for (std::size_t c = 0; c < 3; ++c) from[c][k] = corners[3 * c + k] - corner;
      lowest -= normal[k] * from[0][k];
    }
    highest = lowest;
    for (std::size_t a = 0; a < 3; ++a) {
      Doubles x, y, z, low, high;
      load(boxes.axis[a][0].data() + begin, x);
      load(boxes.axis[a][1].data() + begin, y);
      load(boxes.axis[a][2].data() + begin, z);
      load(boxes.low[a].data() + begin, low);
      load(boxes.high[a].data() + begin, high);
      Doubles at = x * from[0][0] + y * from[0][1] + z * from[0][2], first = at, last = at;
      for (std::size_t c = 1; c < 3; ++c) {
        at = x * from[c][0] + y * from[c][1] + z * from[c][2];
        first = at < first ? at : first;
        last = at > last ? at : last;
      }
      const Doubles ahead = first - high, behind = low - last;
      Doubles sure = (ahead > behind ? ahead : behind) * (1 - 0x1p-20) - 1;
      sure = sure > none ? sure : none;
      sum += sure * sure;
      const Doubles turn = x * normal[0] + y * normal[1] + z * normal[2], of_low = turn * low,
                    of_high = turn * high;
      lowest += of_low < of_high ? of_low : of_high;
      highest += of_low < of_high ? of_high : of_low;
      ends += high - low;  // low is 0 at most, high at least
    }
    const Doubles above = lowest - top, below = bottom - highest;
    Doubles sure = (above > below ? above : below) - ends * 0x1p-20 - 1;
    sure = sure > none ? sure : none;
    const Doubles along = sure * sure;
    sum = (along > sum ? along : sum) * (1 - 0x1p-20);
    std::memcpy(squared.data() + begin, &sum, sizeof sum);
  }
}
