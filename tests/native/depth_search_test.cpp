#include "compute/native/force/depth_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cpu_ref/box_tree.h"
#include "cpu_ref/depth.h"
#include "tests/cpu_ref/lattice_scene.h"

namespace palpate {
namespace {

struct Case {
  std::string name;
  LatticeMesh mesh;
};

/// Triangles that lie anywhere and are needles now and then; none is a sheet.
LatticeMesh soup(std::size_t count, std::int32_t reach, std::int32_t size, unsigned seed) {
  std::mt19937 random(seed);
  const auto within = [&](std::int32_t most) {
    return std::uniform_int_distribution<std::int32_t>(-most, most)(random);
  };
  std::vector<cpu_ref::Triangle> triangles;
  while (triangles.size() < count) {
    const Int3 a(within(reach), within(reach), within(reach)), way(within(size), within(size), within(size));
    const bool needle = triangles.size() % 3 == 0;
    triangles.emplace_back(a, a + way,
                           needle ? a + way / 2 + Int3(within(2), within(2), within(2))
                                  : a + Int3(within(size), within(size), within(size)));
  }
  LatticeMesh mesh = cpu_ref::lattice_mesh_of(triangles);
  for (auto& flags : mesh.flags) flags &= static_cast<std::uint8_t>(~kTriangleSheet);
  return mesh;
}

std::vector<Case> cases() {
  std::vector<Case> out;
  out.push_back(
      {"box", cpu_ref::lattice_mesh_of(cpu_ref::lattice_box(Int3(-1000, -500, -2000), Int3(1000, 700, 90)))});
  out.push_back({"sphere", cpu_ref::lattice_mesh_of(cpu_ref::lattice_sphere(1 << 20, 40, 30))});
  out.push_back(
      {"as large as the lattice", cpu_ref::lattice_mesh_of(cpu_ref::lattice_sphere((1 << 28) - 1, 12, 9))});
  out.push_back({"one triangle", soup(1, 1000, 1000, 1)});
  out.push_back({"eight", soup(8, 1000, 1000, 2)});
  out.push_back({"nine", soup(9, 1000, 1000, 3)});
  out.push_back({"small ones", soup(700, 1 << 16, 60, 4)});
  out.push_back({"far apart", soup(700, 1 << 27, 1 << 12, 5)});
  out.push_back({"long ones", soup(300, 1 << 27, 1 << 27, 6)});
  return out;
}

/// EXACTNESS section 4, asked of every triangle.
DepthSearch::Depth of_all(const LatticeMesh& mesh, const Int3& point) {
  DepthSearch::Depth best{UINT32_MAX, DepthSearch::kNobody, 0};
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if ((mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) != 0) continue;
    const std::uint32_t steps = cpu_ref::distance(mesh, id, point);
    if (steps < best.steps) best = {steps, id, 0};
  }
  return best;
}

TEST(TriangleTree, HoldsEveryTriangleThatBoundsASolidOnceAndItsBoxesHoldThem) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const TriangleTree tree = TriangleTree::make(c.mesh, [] { return true; });
    std::vector<std::uint32_t> sorted = tree.order, wanted;
    std::sort(sorted.begin(), sorted.end());
    for (std::uint32_t id = 0; id < c.mesh.triangles.size(); ++id)
      if ((c.mesh.flags[id] & (kTriangleCollapsed | kTriangleSheet)) == 0) wanted.push_back(id);
    EXPECT_EQ(sorted, wanted);
    ASSERT_FALSE(wanted.empty());
    for (std::size_t place = 0; place < tree.order.size(); ++place)
      for (std::size_t level = 0, node = place / 8; level < tree.level_begin.size(); ++level, node /= 8)
        for (int corner = 0; corner < 3; ++corner)
          for (std::size_t k = 0; k < 3; ++k) {
            const TriangleTree::Boxes& boxes = tree.boxes[tree.level_begin[level] + node / 8];
            const std::int32_t at = c.mesh.corner(tree.order[place], corner)[static_cast<int>(k)];
            ASSERT_LE(boxes.low[k][node % 8], at);
            ASSERT_GE(boxes.high[k][node % 8], at);
          }
    EXPECT_EQ(tree.nodes(static_cast<std::uint32_t>(tree.level_begin.size())), 1u);
    const std::size_t turned = std::min(TriangleTree::kTurnedLevels, tree.level_begin.size());
    for (std::size_t place = 0; place < tree.order.size(); ++place)
      for (std::size_t level = 0, node = place / 8; level < turned; ++level, node /= 8)
        for (int corner = 0; corner < 3; ++corner)
          for (std::size_t a = 0; a < 3; ++a) {
            ASSERT_LT(tree.level_begin[level] + node / 8, tree.turned.size());
            const TriangleTree::TurnedBoxes& boxes = tree.turned[tree.level_begin[level] + node / 8];
            const std::size_t i = node % 8;
            double at = 0, length = 0, across = 0;
            for (std::size_t k = 0; k < 3; ++k) {
              const double axis = boxes.axis[a][k][i];
              at += axis * (double(c.mesh.corner(tree.order[place], corner)[static_cast<int>(k)]) -
                            boxes.corner[k][i]);
              length += axis * axis;
              across += axis * boxes.axis[(a + 1) % 3][k][i];
            }
            ASSERT_LE(boxes.low[a][i], at);
            ASSERT_GE(boxes.high[a][i], at);
            ASSERT_NEAR(length, 1, 0x1p-22);  // each component is rounded by 2^-25 at most
            ASSERT_NEAR(across, 0, 0x1p-22);
          }
  }
}

/// The nearest point of a triangle, in extended precision, by its barycentric coordinates.
using V = std::array<long double, 3>;
V nearest_point(const LatticeMesh& mesh, std::uint32_t id, const V& point) {
  const auto minus = [](const V& a, const V& b) { return V{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto dot = [](const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const auto at = [](const Int3& v) {
    return V{static_cast<long double>(v.x), static_cast<long double>(v.y), static_cast<long double>(v.z)};
  };
  V best{};
  long double least = -1;
  const auto offer = [&](const V& q) {
    const V way = minus(q, point);
    if (const long double squared = dot(way, way); least < 0 || squared < least) least = squared, best = q;
  };
  const V a = at(mesh.corner(id, 0)), b = at(mesh.corner(id, 1)), c = at(mesh.corner(id, 2));
  for (const auto& [u, v] : {std::pair{a, b}, {b, c}, {c, a}}) {
    const V way = minus(v, u);
    const long double t = std::clamp(dot(minus(point, u), way) / dot(way, way), 0.0L, 1.0L);
    offer({u[0] + t * way[0], u[1] + t * way[1], u[2] + t * way[2]});
  }
  const V e = minus(b, a), f = minus(c, a), g = minus(point, a);
  const long double ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), whole = ee * ff - ef * ef,
                    s = (ff * dot(e, g) - ef * dot(f, g)) / whole,
                    t = (ee * dot(f, g) - ef * dot(e, g)) / whole;
  if (s >= 0 && t >= 0 && s + t <= 1)
    offer({a[0] + s * e[0] + t * f[0], a[1] + s * e[1] + t * f[1], a[2] + s * e[2] + t * f[2]});
  return best;
}

TEST(DepthSearch, TheWayOutGoesToTheNearestPointOfTheTriangle) {
  for (const Case& c : cases()) {
    if (c.name != "sphere" && c.name != "box" && c.name != "far apart" && c.name != "as large as the lattice")
      continue;  // needles of a soup have no nearest point that is well known
    SCOPED_TRACE(c.name);
    const TriangleTree tree = TriangleTree::make(c.mesh, [] { return true; });
    DepthSearch search(c.mesh, tree, 100);
    std::mt19937 random(9);
    int edges = 0, faces = 0, near = 0;
    for (int i = 0; i < 4000; ++i) {
      const auto id = static_cast<std::uint32_t>(random() % c.mesh.triangles.size());
      if (c.name == "far apart" && id % 3 == 0) continue;  // the needles
      const Int3 a = c.mesh.corner(id, 0), n = c.mesh.unit_normal_q30[id];
      const double size = std::hypot(c.mesh.corner(id, 1).x - a.x, c.mesh.corner(id, 1).y - a.y,
                                     c.mesh.corner(id, 1).z - a.z);
      const auto within = [&](double most) { return std::uniform_real_distribution(-most, most)(random); };
      Int3 point;
      // Right above or below its middle, and anywhere about it.
      const double up = within(i % 4 == 0 ? 30 : size), beside = i % 4 == 0 ? 0 : within(1.5 * size);
      const Int3 middle = a / 3 + c.mesh.corner(id, 1) / 3 + c.mesh.corner(id, 2) / 3;
      for (int k = 0; k < 3; ++k)
        point[k] = static_cast<std::int32_t>(middle[k] + up * n[k] * 0x1p-30 +
                                             (beside == 0 ? 0 : within(1.5 * size)));
      const std::uint32_t steps = cpu_ref::distance(c.mesh, id, point);
      const Int3 way = search.way_out(point, id, steps);
      ASSERT_EQ(way, cpu_ref::way_out(c.mesh, id, steps, point)) << id;
      if (steps < 64) {
        EXPECT_EQ(way, n);
        ++near;
        continue;
      }
      // So far that way lies the triangle, but for what a distance may be off.
      V reached, p;
      long double own = 0, off = 0;
      for (std::size_t k = 0; k < 3; ++k) p[k] = point[static_cast<int>(k)];
      const V nearest = nearest_point(c.mesh, id, p);
      const long double distance =
          std::hypot(nearest[0] - p[0], std::hypot(nearest[1] - p[1], nearest[2] - p[2]));
      for (std::size_t k = 0; k < 3; ++k) {
        const long double part = way[static_cast<int>(k)] * 0x1p-30L;
        reached[k] = p[k] + distance * part;
        own += part * part;
      }
      const V there = nearest_point(c.mesh, id, reached);
      for (std::size_t k = 0; k < 3; ++k) off += (there[k] - reached[k]) * (there[k] - reached[k]);
      ASSERT_LT(std::sqrt(off), 16) << id << ", " << steps << " steps away";
      ASSERT_NEAR(static_cast<double>(own), 1, 0x1p-26);
      (way == n || way == -n ? faces : edges) += 1;
    }
    EXPECT_GT(edges, 100);
    EXPECT_GT(faces, 100);
    EXPECT_GT(near, 0);
  }
}

TEST(TriangleTree, LeavesSheetsOutAndCanBeCancelled) {
  LatticeMesh mesh = soup(100, 1000, 100, 7);
  mesh.flags[3] |= kTriangleSheet;
  const TriangleTree tree = TriangleTree::make(mesh, [] { return true; });
  EXPECT_EQ(std::count(tree.order.begin(), tree.order.end(), 3u), 0);
  EXPECT_TRUE(TriangleTree::make(mesh, [] { return false; }).order.empty());
  for (auto& flags : mesh.flags) flags |= kTriangleSheet;
  const TriangleTree none = TriangleTree::make(mesh, [] { return true; });
  EXPECT_EQ(DepthSearch(mesh, none, 1).below(Int3(0), DepthSearch::kNobody).triangle, DepthSearch::kNobody);
}

TEST(DepthSearch, SaysWhatAskingEveryTriangleSays) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const TriangleTree tree = TriangleTree::make(c.mesh, [] { return true; });
    DepthSearch search(c.mesh, tree, 1 << 10);
    std::mt19937 random(11);
    const auto any = [&](std::uint32_t below) {
      return std::uniform_int_distribution<std::uint32_t>(0, below - 1)(random);
    };
    const auto triangles = static_cast<std::uint32_t>(tree.order.size());
    std::uint32_t last = DepthSearch::kNobody;
    for (int i = 0; i < 1000; ++i) {
      // On corners, sides and triangles, near them, and anywhere.
      const std::uint32_t id = tree.order[any(triangles)];
      const Int3 a = c.mesh.corner(id, 0), b = c.mesh.corner(id, 1), d = c.mesh.corner(id, 2);
      Int3 point = i % 5 == 0   ? a
                   : i % 5 == 1 ? a / 2 + b / 2
                   : i % 5 == 2 ? a / 3 + b / 3 + d / 3
                   : i % 5 == 3 ? a + (b - a) / 4 * 5
                                : Int3(0);
      const std::int32_t off = std::int32_t{1} << any(29);
      for (int k = 0; k < 3; ++k)
        point[k] =
            std::clamp(point[k] + (i % 2 == 0 ? std::uniform_int_distribution<std::int32_t>(-off, off)(random)
                                              : static_cast<std::int32_t>(any(5)) - 2),
                       -(1 << 29), 1 << 29);
      const std::uint32_t guess = i % 3 == 0 ? DepthSearch::kNobody : i % 3 == 1 ? any(triangles) : last;
      const DepthSearch::Depth found = search.below(point, guess), wanted = of_all(c.mesh, point);
      ASSERT_EQ(found.steps, wanted.steps) << point.x << " " << point.y << " " << point.z;
      ASSERT_EQ(found.triangle, wanted.triangle) << point.x << " " << point.y << " " << point.z;
      ASSERT_EQ(tree.order[found.place], found.triangle);
      last = found.place;
    }
  }
}

// Cubes of space are known from their second point on, and larger ones have more of the tree than there is
// room for: points that lie as close as samples of a contact, about every corner of a mesh.
TEST(DepthSearch, SaysTheSameInACubeThatItKnows) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.name);
    const TriangleTree tree = TriangleTree::make(c.mesh, [] { return true; });
    for (const std::int32_t spacing : {1, 1 << 6, 1 << 12, 1 << 20}) {
      SCOPED_TRACE(spacing);
      DepthSearch search(c.mesh, tree, spacing);
      std::mt19937 random(13);
      const auto within = [&](std::int32_t most) {
        return std::uniform_int_distribution<std::int32_t>(-most, most)(random);
      };
      std::uint32_t last = DepthSearch::kNobody;
      for (int place = 0; place < 30; ++place) {
        const auto id = tree.order[static_cast<std::size_t>(within(1 << 20) & 0xFFFFF) % tree.order.size()];
        const Int3 near = c.mesh.corner(id, place % 3) + spacing * Int3(within(9), within(9), within(9));
        for (int i = 0; i < 8; ++i) {
          const Int3 point = near + Int3(within(2 * spacing), within(2 * spacing), within(2 * spacing));
          const DepthSearch::Depth found = search.below(point, last), wanted = of_all(c.mesh, point);
          ASSERT_EQ(found.steps, wanted.steps) << point.x << " " << point.y << " " << point.z;
          ASSERT_EQ(found.triangle, wanted.triangle) << point.x << " " << point.y << " " << point.z;
          last = found.place;
        }
      }
    }
  }
}

// The worst there is: at one corner of a cube the surface is near, and what is nearest to the opposite corner
// lies further outside than the cube's diagonal, all but a hundredth.
TEST(DepthSearch, KnowsOfACubeWhatIsNearestToItsDeepestPoint) {
  constexpr std::int32_t kSpacing = 1 << 10, kEdge = 8 * kSpacing;
  const auto most = static_cast<std::int32_t>(0.99 * std::sqrt(3.0) * kEdge);
  std::vector<cpu_ref::Triangle> triangles;
  for (std::int32_t i = 0; i < 400; ++i) {  // half of them here, half there
    const Int3 a = (i % 2 == 0 ? Int3(-60) : Int3(kEdge + most, kEdge, kEdge)) + Int3(i % 20, i / 20, 0);
    triangles.emplace_back(a, a + Int3(9, 0, 1), a + Int3(0, 9, 2));
  }
  LatticeMesh mesh = cpu_ref::lattice_mesh_of(triangles);
  for (auto& flags : mesh.flags) flags &= static_cast<std::uint8_t>(~kTriangleSheet);
  const TriangleTree tree = TriangleTree::make(mesh, [] { return true; });
  DepthSearch search(mesh, tree, kSpacing);
  for (int times = 0; times < 3; ++times)
    EXPECT_EQ(search.below(Int3(1), DepthSearch::kNobody).triangle, of_all(mesh, Int3(1)).triangle);
  const Int3 deepest(kEdge - 1);
  const DepthSearch::Depth wanted = of_all(mesh, deepest);
  ASSERT_GT(mesh.corner(wanted.triangle, 0).x, kEdge);
  EXPECT_EQ(search.below(deepest, DepthSearch::kNobody).triangle, wanted.triangle);
}

TEST(DepthSearch, LooksAtLessInACubeThatItKnows) {
  const LatticeMesh mesh = cpu_ref::lattice_mesh_of(cpu_ref::lattice_sphere(1 << 20, 200, 100));
  const TriangleTree tree = TriangleTree::make(mesh, [] { return true; });
  DepthSearch search(mesh, tree, 1 << 12);
  const auto looks = [&](int of) {
    const std::uint64_t before = search.looks();
    search.below(Int3((1 << 20) - 9000 + of, 1000, 2000), DepthSearch::kNobody);
    return search.looks() - before;
  };
  const std::uint64_t first = looks(0), second = looks(1), third = looks(2);
  EXPECT_GT(second, first) << "it finds out what is near";
  EXPECT_LT(third, first);
}

TEST(Reference, FindsTheNearestThatBoundsASolid) {
  LatticeMesh mesh = soup(100, 1000, 100, 7);
  for (std::size_t id = 0; id < mesh.flags.size(); id += 2) mesh.flags[id] |= kTriangleSheet;
  std::vector<cpu_ref::Box> boxes(mesh.triangles.size());
  for (std::uint32_t id = 0; id < boxes.size(); ++id)
    for (int k = 0; k < 3; ++k) boxes[id].include(mesh.corner(id, k));
  cpu_ref::BoxTree tree;
  tree.build(std::move(boxes));
  std::mt19937 random(12);
  const auto within = [&] { return std::uniform_int_distribution<std::int32_t>(-1200, 1200)(random); };
  for (int i = 0; i < 200; ++i) {
    const Int3 point(within(), within(), within());
    const DepthSearch::Depth wanted = of_all(mesh, point);
    const std::optional<cpu_ref::Depth> found = cpu_ref::nearest(mesh, tree, point);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->steps, wanted.steps);
    EXPECT_EQ(found->triangle, wanted.triangle);
  }
}

}  // namespace
}  // namespace palpate
