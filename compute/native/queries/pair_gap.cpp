#include "compute/native/queries/pair_gap.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpate::exact {
namespace {

__extension__ using UWide = unsigned __int128;

// Features, in the order of section 10: corner i of m with s's face (4 i) and its edges (4 i + 1 + e), corner
// i of s with m's (12 more), then edge i of s with edge j of m (24 + 3 i + j).
constexpr int kCorners = 24, kFeatures = 33;

/// 256 bits.
struct Product {
  UWide high, low;
};
Product times(UWide a, UWide b) {
  const UWide mask = UINT64_MAX, a0 = a & mask, a1 = a >> 64, b0 = b & mask, b1 = b >> 64;
  const UWide low = a0 * b0, x = a1 * b0 + (low >> 64), y = a0 * b1 + (x & mask);
  return {a1 * b1 + (x >> 64) + (y >> 64), (y << 64) | (low & mask)};
}
bool at_most(const Product& a, const Product& b) {
  return a.high != b.high ? a.high < b.high : a.low <= b.low;
}

UWide size(Wide v) { return v < 0 ? -static_cast<UWide>(v) : static_cast<UWide>(v); }
Wide square(const Normal& n) { return Wide{n.x} * n.x + Wide{n.y} * n.y + Wide{n.z} * n.z; }  // within 2^120
Wide dot(const Normal& a, const Normal& b) { return Wide{a.x} * b.x + Wide{a.y} * b.y + Wide{a.z} * b.z; }
// Within 2^60.1.
std::int64_t dot(const Int3& a, const Int3& b) {
  return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z;
}

/// floor(√(num / den)): `guess` from doubles, then the integers have the last word. num within 2^121.
std::int32_t root(UWide num, UWide den) {
  auto d = static_cast<std::int64_t>(std::sqrt(static_cast<double>(num) / static_cast<double>(den)));
  const auto fits = [&](std::int64_t v) {
    return at_most(times(static_cast<UWide>(v) * static_cast<UWide>(v), den), {0, num});
  };
  while (d > 0 && !fits(d)) --d;
  while (fits(d + 1)) ++d;
  return static_cast<std::int32_t>(d);
}
/// floor(|h| / √den): |h| within 2^91, den within 2^121.
std::int32_t quotient_of_root(Wide h, Wide den) {
  const UWide over = size(h);
  const Product squared = times(over, over);
  auto d = static_cast<std::int64_t>(static_cast<double>(over) / std::sqrt(static_cast<double>(den)));
  const auto fits = [&](std::int64_t v) {
    return at_most(times(static_cast<UWide>(v) * static_cast<UWide>(v), static_cast<UWide>(den)), squared);
  };
  while (d > 0 && !fits(d)) --d;
  while (fits(d + 1)) ++d;
  return static_cast<std::int32_t>(d);
}

/// round(factor · num / den), halves up; den > 0 within 2^122, |num| within 2^122. Bit by bit: the product
/// does not fit.
std::int64_t scaled(std::int64_t factor, Wide num, Wide den) {
  const bool negative = (factor < 0) != (num < 0);
  const UWide n = size(num), d = static_cast<UWide>(den);
  UWide whole = n / d, part = n % d, quotient = 0, rest = 0;  // factor · (whole + part / den)
  const auto f = static_cast<std::uint64_t>(std::llabs(factor));
  for (int bit = 63; bit >= 0; --bit) {
    quotient <<= 1;
    rest <<= 1;
    if ((f >> bit & 1) != 0) rest += part;
    while (rest >= d) {
      rest -= d;
      ++quotient;
    }
  }
  quotient += whole * f;
  // Now |value| = quotient + rest / den.
  const bool up = negative ? 2 * rest > d : 2 * rest >= d;
  const auto rounded = static_cast<std::int64_t>(quotient) + (up ? 1 : 0);
  return negative ? -rounded : rounded;
}

/// Whether the foot of p's perpendicular lies in the closed triangle.
bool above_face(const Int3& p, const Corners& t, const Normal& n) {
  for (std::size_t e = 0; e < 3; ++e)
    if (dot(n, cross(t[(e + 1) % 3] - t[e], p - t[e])) < 0) return false;  // within 2^120
  return true;
}

/// A point and a segment: the squared distance as a quotient.
struct Quotient {
  Wide num, den;
};
Quotient to_segment(const Int3& p, const Int3& a, const Int3& b) {
  const Int3 u = b - a, w = p - a;
  const std::int64_t along = dot(u, w), length = dot(u, u);
  if (along <= 0) return {dot(w, w), 1};
  if (along >= length) return {dot(p - b, p - b), 1};
  return {square(cross(u, w)), length};
}

/// Where the lines of two edges come nearest: numerators s of u and t of v over den. False: they are
/// parallel, or come nearest beyond an end.
struct Crossing {
  Wide s, t, den, height;
};
bool inner_crossing(const Int3& a, const Int3& b, const Int3& c, const Int3& d, Crossing& out) {
  const Int3 u = b - a, v = d - c, w = c - a;
  const Normal n = cross(u, v);
  out.den = square(n);
  if (out.den == 0) return false;
  out.s = dot(cross(w, v), n);
  out.t = dot(cross(w, u), n);
  if (out.s < 0 || out.s > out.den || out.t < 0 || out.t > out.den) return false;
  out.height = dot(n, w);
  return true;
}

/// How far a feature's two parts are apart; INT32_MAX where they are not nearest to each other there, or
/// further than `most` for certain.
std::int32_t feature_gap(const Corners& s, const Corners& m, int feature, const Normal& s_normal,
                         const Normal& m_normal) {
  if (feature < kCorners) {
    const bool of_m = feature < 12;
    const Int3& p = (of_m ? m : s)[static_cast<std::size_t>(feature % 12 / 4)];
    const Corners& t = of_m ? s : m;
    const Normal& n = of_m ? s_normal : m_normal;
    if (feature % 4 == 0)  // a segment has no face
      return !(n == Normal{}) && above_face(p, t, n) ? quotient_of_root(dot(n, p - t[0]), square(n))
                                                     : INT32_MAX;
    const auto e = static_cast<std::size_t>(feature % 4 - 1);
    const Quotient q = to_segment(p, t[e], t[(e + 1) % 3]);
    return root(static_cast<UWide>(q.num), static_cast<UWide>(q.den));
  }
  const auto i = static_cast<std::size_t>((feature - kCorners) / 3),
             j = static_cast<std::size_t>((feature - kCorners) % 3);
  Crossing crossing;
  if (!inner_crossing(s[i], s[(i + 1) % 3], m[j], m[(j + 1) % 3], crossing)) return INT32_MAX;
  return quotient_of_root(crossing.height, crossing.den);
}

/// A rough distance of a corner's feature from below, so that most need no wide numbers: to a segment, in
/// doubles.
double rough_segment(const Int3& p, const Int3& a, const Int3& b) {
  const Int3 u = b - a, w = p - a;
  const double ux = u.x, uy = u.y, uz = u.z, wx = w.x, wy = w.y, wz = w.z, uu = ux * ux + uy * uy + uz * uz,
               uw = ux * wx + uy * wy + uz * wz;
  const double t = uu > 0 ? std::min(std::max(uw / uu, 0.0), 1.0) : 0.0;
  const double x = wx - t * ux, y = wy - t * uy, z = wz - t * uz;
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

Gap gap(const Corners& s, const Corners& m, std::int32_t most) {
  const Normal s_normal = raw_normal(s), m_normal = raw_normal(m);
  Gap best{most < INT32_MAX ? most + 1 : INT32_MAX, -1};
  for (int feature = 0; feature < kFeatures; ++feature) {
    if (feature < kCorners && feature % 4 != 0) {
      const bool of_m = feature < 12;
      const auto e = static_cast<std::size_t>(feature % 4 - 1);
      const Corners& t = of_m ? s : m;
      // Doubles are off by far less than a step here: differences below 2^30, few roundings of 2^-53 each.
      if (rough_segment((of_m ? m : s)[static_cast<std::size_t>(feature % 12 / 4)], t[e], t[(e + 1) % 3]) >
          best.steps + 1.0)
        continue;
    }
    const std::int32_t steps = feature_gap(s, m, feature, s_normal, m_normal);
    if (steps < best.steps) best = {steps, feature};
  }
  return best;
}

void witnesses(const Corners& s, const Corners& m, int feature, Int3& on_s, Int3& on_m) {
  if (feature < kCorners) {
    const bool of_m = feature < 12;
    const Int3& p = (of_m ? m : s)[static_cast<std::size_t>(feature % 12 / 4)];
    const Corners& t = of_m ? s : m;
    Int3 foot = p;
    if (feature % 4 == 0) {
      const Normal n = raw_normal(t);
      const Wide h = dot(n, p - t[0]), den = square(n);
      foot.x = static_cast<std::int32_t>(p.x + scaled(n.x, -h, den));
      foot.y = static_cast<std::int32_t>(p.y + scaled(n.y, -h, den));
      foot.z = static_cast<std::int32_t>(p.z + scaled(n.z, -h, den));
    } else {
      const auto e = static_cast<std::size_t>(feature % 4 - 1);
      const Int3 &a = t[e], &b = t[(e + 1) % 3];
      const Int3 u = b - a;
      const std::int64_t length = dot(u, u),
                         along = std::min(std::max(dot(u, p - a), std::int64_t{0}), length);
      for (int k = 0; k < 3; ++k) foot[k] = static_cast<std::int32_t>(a[k] + scaled(u[k], along, length));
    }
    (of_m ? on_m : on_s) = p;
    (of_m ? on_s : on_m) = foot;
    return;
  }
  const auto i = static_cast<std::size_t>((feature - kCorners) / 3),
             j = static_cast<std::size_t>((feature - kCorners) % 3);
  const Int3 &a = s[i], &b = s[(i + 1) % 3], &c = m[j], &d = m[(j + 1) % 3];
  Crossing crossing;
  inner_crossing(a, b, c, d, crossing);
  for (int k = 0; k < 3; ++k) {
    on_s[k] = static_cast<std::int32_t>(a[k] + scaled(b[k] - a[k], crossing.s, crossing.den));
    on_m[k] = static_cast<std::int32_t>(c[k] + scaled(d[k] - c[k], crossing.t, crossing.den));
  }
}

}  // namespace palpate::exact
