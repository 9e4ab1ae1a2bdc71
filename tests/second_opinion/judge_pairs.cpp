#include "tests/second_opinion/judge_pairs.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include <algorithm>
#include <stdexcept>

namespace second_opinion {
namespace {

// Lattice points are doubles without rounding, so this kernel's predicates are exact; what has to be
// constructed is done by the other.
using Predicates = CGAL::Exact_predicates_inexact_constructions_kernel;
using Constructions = CGAL::Exact_predicates_exact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<int, 3, std::uint32_t>;

template <class Kernel>
typename Kernel::Triangle_3 exact(const Triangle& t) {
  const auto point = [](const Point& p) { return typename Kernel::Point_3(p[0], p[1], p[2]); };
  return {point(t[0]), point(t[1]), point(t[2])};
}

Box box_of(const Triangle& t, std::uint32_t id) {
  std::array<int, 3> low{}, high{};
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = std::min({t[0][k], t[1][k], t[2][k]});
    high[k] = std::max({t[0][k], t[1][k], t[2][k]});
  }
  return Box(low.data(), high.data(), id);
}

std::vector<bool> voids(const std::vector<Triangle>& triangles) {
  std::vector<bool> found;
  for (const Triangle& t : triangles) found.push_back(exact<Predicates>(t).is_degenerate());
  return found;
}

std::vector<Box> boxes_of(const std::vector<Triangle>& triangles, const std::vector<bool>& left_out) {
  std::vector<Box> boxes;
  for (std::uint32_t id = 0; id < triangles.size(); ++id)
    if (!left_out[id]) boxes.push_back(box_of(triangles[id], id));
  return boxes;
}

/// Whether p, in the plane of t, lies off all its edges' lines on the inner side.
bool strictly_inside(const Constructions::Triangle_3& t, const Constructions::Point_3& p) {
  for (int k = 0; k < 3; ++k)
    if (CGAL::coplanar_orientation(t[k], t[(k + 1) % 3], t[(k + 2) % 3], p) != CGAL::POSITIVE) return false;
  return true;
}

}  // namespace

PairJudge::PairJudge(const std::vector<Triangle>& statics, const std::vector<Triangle>& tool)
    : statics_(statics), static_void_(voids(statics)), tool_void_(voids(tool)) {}

Pairs PairJudge::pairs(const std::vector<Triangle>& moved) const {
  if (moved.size() != tool_void_.size())
    throw std::runtime_error("a pose has another number of tool triangles than the first");
  std::vector<bool> left_out = voids(moved);
  for (std::size_t m = 0; m < moved.size(); ++m) left_out[m] = left_out[m] || tool_void_[m];
  std::vector<Box> static_boxes = boxes_of(statics_, static_void_), mobile_boxes = boxes_of(moved, left_out);
  Pairs found;
  CGAL::box_intersection_d(
      static_boxes.begin(), static_boxes.end(), mobile_boxes.begin(), mobile_boxes.end(),
      [&](const Box& s, const Box& m) {
        if (CGAL::do_intersect(exact<Predicates>(statics_[s.info()]), exact<Predicates>(moved[m.info()])))
          found.emplace_back(s.info(), m.info());
      });
  std::sort(found.begin(), found.end());
  return found;
}

Meeting PairJudge::meeting(const Triangle& s, const Triangle& m) const {
  const auto a = exact<Constructions>(s), b = exact<Constructions>(m);
  const auto common = CGAL::intersection(a, b);
  if (!common) throw std::runtime_error("CGAL finds that two triangles intersect, but no intersection");
  if (const auto* segment = boost::get<Constructions::Segment_3>(&*common)) {
    const auto middle = CGAL::midpoint(segment->source(), segment->target());
    const bool coplanar = CGAL::coplanar(a[0], a[1], a[2], b[0]) && CGAL::coplanar(a[0], a[1], a[2], b[1]) &&
                          CGAL::coplanar(a[0], a[1], a[2], b[2]);
    return !coplanar && strictly_inside(a, middle) && strictly_inside(b, middle) ? Meeting::kCross
                                                                                 : Meeting::kTouch;
  }
  return boost::get<Constructions::Point_3>(&*common) ? Meeting::kTouch : Meeting::kOverlap;
}

}  // namespace second_opinion
