#include "tests/second_opinion/judge_voxels.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>

namespace second_opinion {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;  // lattice points are exact doubles, only
                                                                     // predicates are asked
using Triangles = std::vector<Kernel::Triangle_3>;
using Tree = CGAL::AABB_tree<
    CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>>;

Kernel::Point_3 exact(const Point& p) { return {double(p[0]), double(p[1]), double(p[2])}; }

/// Whether every directed edge is undone by one the other way.
bool edges_cancel(const Triangles& triangles) {
  std::map<std::pair<Kernel::Point_3, Kernel::Point_3>, int> incidence;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto &u = t[k], &v = t[(k + 1) % 3];
      u < v ? ++incidence[{u, v}] : --incidence[{v, u}];
    }
  return std::all_of(incidence.begin(), incidence.end(), [](const auto& edge) { return edge.second == 0; });
}

/// First and last cube along an axis whose closed cube meets [low, high].
std::pair<std::int64_t, std::int64_t> cubes(const Voxels& voxels, std::size_t axis, std::int64_t low,
                                            std::int64_t high) {
  const std::int64_t from = low - voxels.origin[axis], to = high - voxels.origin[axis], size = voxels.size;
  const auto floor_div = [](std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); };
  const auto last = static_cast<std::int64_t>(voxels.counts[axis]) - 1;
  return {std::max<std::int64_t>(floor_div(from - 1, size), 0), std::min(floor_div(to, size), last)};
}

class Winding {
 public:
  Winding(const Triangles& triangles, std::uint32_t seed)
      : tree_(triangles.begin(), triangles.end()), random_(seed) {
    tree_.build();
  }

  /// At a point on no triangle.
  int at(const Kernel::Point_3& p) {
    while (true)
      if (const std::optional<int> winding = along(p, any_direction())) return *winding;
  }

 private:
  /// Beyond every triangle: coordinates are within 2^28, and the largest component here is above 2^29.
  Kernel::Vector_3 any_direction() {
    std::uniform_int_distribution<int> draw(-(1 << 30), 1 << 30);
    while (true) {
      const int x = draw(random_), y = draw(random_), z = draw(random_);
      if (std::max({std::abs(x), std::abs(y), std::abs(z)}) > 1 << 29)
        return {double(x), double(y), double(z)};
    }
  }
  /// Nothing when the ray meets an edge or a vertex: then another direction decides.
  std::optional<int> along(const Kernel::Point_3& p, const Kernel::Vector_3& direction) {
    const Kernel::Point_3 far(p.x() + direction.x(), p.y() + direction.y(),
                              p.z() + direction.z());  // integers below 2^32: exact
    hits_.clear();
    tree_.all_intersected_primitives(Kernel::Segment_3(p, far), std::back_inserter(hits_));
    int winding = 0;
    for (const auto& hit : hits_) {
      for (int k = 0; k < 3; ++k)
        if (CGAL::orientation(p, far, (*hit)[k], (*hit)[(k + 1) % 3]) == CGAL::ZERO) return std::nullopt;
      winding += CGAL::orientation((*hit)[0], (*hit)[1], (*hit)[2], far);  // +1: leaves through the front
    }
    return winding;
  }

  Tree tree_;
  std::mt19937 random_;
  std::vector<Tree::Primitive_id> hits_;
};

}  // namespace

VoxelVerdict judge_voxels(const std::vector<Triangle>& statics, const Voxels& voxels, std::size_t stride) {
  VoxelVerdict verdict;
  const auto [nx, ny, nz] = voxels.counts;
  const auto corner = [&](std::size_t axis, std::size_t i) {
    return double(voxels.origin[axis]) + double(voxels.size) * double(i);
  };
  const auto differ = [&](std::size_t v, const char* expected) {
    if (!verdict.first_difference.empty()) return;
    verdict.first_difference = "voxel (" + std::to_string(v % nx) + ", " + std::to_string(v / nx % ny) +
                               ", " + std::to_string(v / nx / ny) + ") has class " +
                               std::to_string(voxels.classes[v]) + ", CGAL says " + expected;
  };

  // V_bnd.
  Triangles triangles;
  std::vector<bool> boundary(voxels.classes.size(), false);
  for (const Triangle& t : statics) {
    const Kernel::Triangle_3 triangle(exact(t[0]), exact(t[1]), exact(t[2]));
    if (triangle.is_degenerate()) continue;
    triangles.push_back(triangle);
    std::array<std::pair<std::int64_t, std::int64_t>, 3> range;
    for (std::size_t k = 0; k < 3; ++k)
      range[k] =
          cubes(voxels, k, std::min({t[0][k], t[1][k], t[2][k]}), std::max({t[0][k], t[1][k], t[2][k]}));
    for (auto z = std::size_t(range[2].first); z <= std::size_t(range[2].second); ++z)
      for (auto y = std::size_t(range[1].first); y <= std::size_t(range[1].second); ++y)
        for (auto x = std::size_t(range[0].first); x <= std::size_t(range[0].second); ++x) {
          const std::size_t v = x + nx * (y + ny * z);
          if (boundary[v]) continue;
          const Kernel::Iso_cuboid_3 cube(
              Kernel::Point_3(corner(0, x), corner(1, y), corner(2, z)),
              Kernel::Point_3(corner(0, x + 1), corner(1, y + 1), corner(2, z + 1)));
          boundary[v] = CGAL::do_intersect(cube, triangle);
        }
  }
  for (std::size_t v = 0; v < boundary.size(); ++v) {
    const bool said = voxels.classes[v] == kBoundary;
    verdict.boundary += boundary[v] ? 1u : 0u;
    if (boundary[v] == said) continue;
    ++(said ? verdict.extra_boundary : verdict.missing_boundary);
    differ(v, said ? "that no triangle touches it" : "that a triangle touches it");
  }

  // Inside and outside.
  verdict.closed = edges_cancel(triangles);
  if (!verdict.closed || triangles.empty()) return verdict;
  Winding winding(triangles, 1);
  const double half = voxels.size / 2;  // a voxel's size is even
  for (std::size_t v = 0, seen = 0; v < boundary.size(); ++v) {
    if (boundary[v] || seen++ % stride != 0) continue;
    const bool inside = winding.at(Kernel::Point_3(corner(0, v % nx) + half, corner(1, v / nx % ny) + half,
                                                   corner(2, v / nx / ny) + half)) != 0;
    ++verdict.judged;
    verdict.internal += inside ? 1u : 0u;
    if (voxels.classes[v] == (inside ? kInternal : kExternal)) continue;
    ++verdict.wrong;
    differ(v, inside ? "that its centre is inside" : "that its centre is outside");
  }
  return verdict;
}

}  // namespace second_opinion
