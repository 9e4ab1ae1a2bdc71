// Included by ray_shadows.cpp alone, once for each processor's code (processor.h); so it guards nothing and includes nothing. kWidth: doubles in a
// vector of the processor's.

using Doubles = double __attribute__((vector_size(8 * kWidth)));
using Masks = std::int64_t __attribute__((vector_size(8 * kWidth)));   // all bits of a lane, or none
using Words = std::int32_t __attribute__((vector_size(4 * kWidth)));

static void load(const std::int32_t* from, Doubles& out) {
  Words words;
  std::memcpy(&words, from, sizeof words);
  out = __builtin_convertvector(words, Doubles);
}
static void store(const Doubles& v, double* out) { std::memcpy(out, &v, sizeof v); }
static void store(const Doubles& v, std::int32_t* out) {
  const Words words = __builtin_convertvector(v, Words);
  std::memcpy(out, &words, sizeof words);
}
static void least(const Doubles (&v)[3], Doubles& out) {
  const Doubles two = v[0] < v[1] ? v[0] : v[1];
  out = two < v[2] ? two : v[2];
}
static void most(const Doubles (&v)[3], Doubles& out) {
  const Doubles two = v[0] < v[1] ? v[1] : v[0];
  out = two < v[2] ? v[2] : two;
}
// As RayView::square().
static void square(const RayView& view, std::size_t axis, const Doubles& at, std::int32_t* out) {
  const Doubles none{}, end = none + view.last[axis], squares = (at - view.low[axis]) * view.per_step[axis], inside = squares < none ? none : squares;
  store(inside < end ? inside : end, out);
}

static void see_from(const RayView& view, std::size_t begin, EightShadows& out) {
  Doubles x[3], y[3], z[3], u[3], v[3];   // u and v: x and y before they are sheared
  for (std::size_t corner = 0; corner < 3; ++corner) {
    load(out.corner[3 * corner] + begin, u[corner]);
    load(out.corner[3 * corner + 1] + begin, v[corner]);
    load(out.corner[3 * corner + 2] + begin, z[corner]);
    x[corner] = u[corner] - z[corner] * view.shear[0];
    y[corner] = v[corner] - z[corner] * view.shear[1];
  }
  const Doubles none{};
  Doubles low, high, length, size;
  least(z, low);
  most(z, high);
  length = high - low;
  Masks may = (view.towards < 0 ? -low : high) >= none + view.least;
  const double slack = view.reach * kSlack;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    least(axis == 0 ? x : y, low);
    most(axis == 0 ? x : y, high);
    low -= slack;
    high += slack;
    may &= (low <= none + view.high[axis]) & (high >= none + view.low[axis]);
    square(view, axis, low, out.first[axis] + begin);
    square(view, axis, high, out.last[axis] + begin);
    least(axis == 0 ? u : v, low);
    most(axis == 0 ? u : v, high);
    size = high - low;
    length = length < size ? size : length;
  }
  const Words words = __builtin_convertvector(may, Words);
  std::memcpy(out.may + begin, &words, sizeof words);
  for (std::size_t e = 0; e < 3; ++e) {
    const std::size_t next = (e + 1) % 3;
    const Doubles up = z[next] - z[e], b = u[next] - u[e] - up * view.shear[0], a = up * view.shear[1] - (v[next] - v[e]);
    store(a, out.a[e] + begin);
    store(b, out.b[e] + begin);
    store(-a * x[e] - b * y[e], out.c[e] + begin);
  }
  store(length, out.length + begin);
  store(length * view.reach * kBound, out.bound + begin);
}

static void see_lanes(const RayView& view, EightShadows& out) {
  for (std::size_t begin = 0; begin < kEight; begin += kWidth) see_from(view, begin, out);
}

// Where rays in a row of squares may lie beside a triangle: of a long one across the squares its box says little.
struct Band {
  double a[3], b[3], least[3];   // edges turned so that the triangle is on their positive side: a·x + b·y ≥ least where a ray may meet it
  bool known;                    // on which side that is
};
static void band_of(const EightShadows& t, std::size_t i, Band& out) {
  const double sum = t.c[0][i] + t.c[1][i] + t.c[2][i], bound = t.bound[i];   // twice the area; off by less than 2 bound
  out.known = sum > 4 * bound || sum < -4 * bound;
  for (std::size_t e = 0; e < 3; ++e) {
    const double turn = sum < 0 ? -1 : 1, a = turn * t.a[e][i];
    out.a[e] = a;
    out.b[e] = turn * t.b[e][i];
    out.least[e] = -2 * bound - turn * t.c[e][i];
  }
}
static void clip(const RayView& view, const Band& band, std::int32_t row, std::int32_t& first, std::int32_t& last) {
  const double slack = view.reach * kSlack, height = 1 / view.per_step[1];
  const double y0 = view.low[1] + row * height - slack, y1 = view.low[1] + (row + 1) * height + slack;
  for (std::size_t e = 0; e < 3; ++e) {
    const double a = band.a[e], below = band.b[e] * y0, above = band.b[e] * y1;
    if (a == 0) continue;
    const double x = (band.least[e] - (below < above ? above : below)) / a;
    if (a > 0) {
      const auto from = static_cast<std::int32_t>(view.square(0, x - slack));
      first = first < from ? from : first;
    } else {
      const auto to = static_cast<std::int32_t>(view.square(0, x + slack));
      last = to < last ? to : last;
    }
  }
}

static std::size_t meet_rows(const RayView& view, const RayRows& rows, const EightShadows& t, std::size_t i, std::uint32_t* out) {
  const Doubles none{};
  const Doubles a0 = none + t.a[0][i], a1 = none + t.a[1][i], a2 = none + t.a[2][i];
  const Doubles b0 = none + t.b[0][i], b1 = none + t.b[1][i], b2 = none + t.b[2][i];
  const Doubles c0 = none + t.c[0][i], c1 = none + t.c[1][i], c2 = none + t.c[2][i];
  const Doubles above = none + t.bound[i], below = -above;
  Band band;
  bool has_band = false;
  std::size_t count = 0;
  for (std::int32_t row = t.first[1][i]; row <= t.last[1][i]; ++row) {
    const std::uint32_t* of_row = rows.first + static_cast<std::size_t>(row) * rows.columns;
    std::int32_t first = t.first[0][i], last = t.last[0][i];
    if (of_row[last + 1] - of_row[first] > kMany) {
      if (!has_band) band_of(t, i, band);
      has_band = true;
      if (band.known) clip(view, band, row, first, last);
      if (first > last) continue;
    }
    const std::uint32_t end = of_row[last + 1];
    for (std::uint32_t ray = of_row[first]; ray < end; ray += kWidth) {
      Doubles x, y;
      std::memcpy(&x, rows.x + ray, sizeof x);
      std::memcpy(&y, rows.y + ray, sizeof y);
      const Doubles e0 = a0 * x + b0 * y + c0, e1 = a1 * x + b1 * y + c1, e2 = a2 * x + b2 * y + c2;
      // On one side of an edge and on the other of another, both beyond doubt, is beside the triangle.
      const Masks beside = ((e0 < below) | (e1 < below) | (e2 < below)) & ((e0 > above) | (e1 > above) | (e2 > above));
      for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
        out[count] = ray + lane;
        count += (beside[lane] == 0) & (ray + lane < end) ? 1u : 0u;
      }
    }
  }
  return count;
}
