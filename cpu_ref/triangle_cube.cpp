#include "cpu_ref/triangle_cube.h"

#include <utility>

#include "cpu_ref/triangle_triangle.h"

namespace palpate::cpu_ref {
namespace {

/// A fraction of the way from p to q. Numerator and denominator within 2^30, so cross products fit 64 bits.
struct Fraction {
  std::int64_t numerator = 0, denominator = 1;  ///< denominator > 0
};
bool less(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}

}  // namespace

bool segment_meets_box(const Int3& p, const Int3& q, const Box& box) {
  Fraction enter{0, 1}, leave{1, 1};
  for (int k = 0; k < 3; ++k) {
    const std::int64_t along = std::int64_t{q[k]} - p[k];
    const std::int64_t to_min = std::int64_t{box.min[k]} - p[k], to_max = std::int64_t{box.max[k]} - p[k];
    if (along == 0) {
      if (to_min > 0 || to_max < 0) return false;
      continue;
    }
    Fraction first = along > 0 ? Fraction{to_min, along} : Fraction{-to_max, -along};
    Fraction last = along > 0 ? Fraction{to_max, along} : Fraction{-to_min, -along};
    if (less(enter, first)) enter = first;
    if (less(last, leave)) leave = last;
    if (less(leave, enter)) return false;
  }
  return true;
}

bool triangle_meets_box(const Triangle& triangle, const Box& box) {
  if (!triangle.box().meets(box)) return false;
  for (int k = 0; k < 3; ++k)
    if (segment_meets_box(triangle[k], triangle[(k + 1) % 3], box)) return true;
  // No edge enters the box. The plane cuts the box in a convex polygon that is then wholly inside the
  // triangle or wholly outside. The diagonal that runs most along N has a point of that polygon, if there is
  // one at all.
  Int3 low, high;
  for (int k = 0; k < 3; ++k) {
    low[k] = triangle.normal[k] >= 0 ? box.min[k] : box.max[k];
    high[k] = triangle.normal[k] >= 0 ? box.max[k] : box.min[k];
  }
  return segment_meets_triangle(low, high, triangle);
}

}  // namespace palpate::cpu_ref
