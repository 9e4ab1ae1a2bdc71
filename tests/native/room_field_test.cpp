// How far places are from a mock-up at least, as RoomField and DistanceLattice promise, against the distance
// to every triangle. A promise holds, and is no worse than cells and nodes make it.
#include "compute/native/queries/room_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <thread>
#include <vector>

#include "compute/scene/triangle_tree.h"
#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "model/scene/geometry_build.h"
#include "tests/equivalence/random.h"

namespace palpate::native {
namespace {

/// By the parts of space in which a corner, an edge or the face is nearest.
double distance_to(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, bc = c - b;
  const auto to = [&](const Vec3& q) { return glm::length(p - q); };
  const double at_ab = glm::dot(p - a, ab), at_ac = glm::dot(p - a, ac), at_ba = glm::dot(p - b, -ab),
               at_bc = glm::dot(p - b, bc), at_ca = glm::dot(p - c, -ac), at_cb = glm::dot(p - c, -bc);
  if (at_ab <= 0 && at_ac <= 0) return to(a);
  if (at_ba <= 0 && at_bc <= 0) return to(b);
  if (at_ca <= 0 && at_cb <= 0) return to(c);
  const Vec3 n = glm::cross(ab, ac);
  const auto beyond = [&](const Vec3& from, const Vec3& edge) {
    return glm::dot(glm::cross(n, edge), p - from) <= 0;
  };
  if (beyond(a, ab) && at_ab > 0 && at_ba > 0) return to(a + ab * (at_ab / glm::dot(ab, ab)));
  if (beyond(b, bc) && at_bc > 0 && at_cb > 0) return to(b + bc * (at_bc / glm::dot(bc, bc)));
  if (beyond(c, -ac) && at_ca > 0 && at_ac > 0) return to(c - ac * (at_ca / glm::dot(ac, ac)));
  return std::abs(glm::dot(n, p - a)) / glm::length(n);
}

struct Scene {
  Scene(const Mesh& mockup, const Mesh& tool)
      : geometry(*build_geometry(mockup, tool, {})),
        tree(TriangleTree::make(
            geometry.mockup, [] { return true; }, kTriangleCollapsed)),
        field(RoomField::of(geometry, tree)) {}

  double distance(const Vec3& p) const {
    const LatticeMesh& mesh = geometry.mockup;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id)
      if (!mesh.collapsed(id))
        least = std::min(least, distance_to(p, Vec3(mesh.corner(id, 0)), Vec3(mesh.corner(id, 1)),
                                            Vec3(mesh.corner(id, 2))));
    return least;
  }
  Vec3 low() const { return Vec3(geometry.mockup.box_min); }
  Vec3 high() const { return Vec3(geometry.mockup.box_max); }
  double longest() const {
    const Vec3 side = high() - low();
    return std::max({side.x, side.y, side.z});
  }
  /// Anywhere in the mock-up's box, or up to so many of its longest side beyond.
  Vec3 place(equivalence::Random& random, double beyond) const {
    const Vec3 more(beyond * longest()), from = low() - more, to = high() + more;
    return from + (to - from) * Vec3{random.unit(), random.unit(), random.unit()};
  }
  /// Whether a place lies in its box; beyond, a place is as far as the way to the box makes it.
  bool holds(const Vec3& p) const { return glm::clamp(p, low(), high()) == p; }
  /// Near a corner of a triangle.
  Vec3 near_surface(equivalence::Random& random, double reach) const {
    const LatticeMesh& mesh = geometry.mockup;
    const auto id = static_cast<std::uint32_t>(random.below(mesh.triangles.size()));
    const auto some = [&] { return 2 * random.unit() - 1; };
    return Vec3(mesh.corner(id, static_cast<int>(random.below(3)))) + reach * Vec3(some(), some(), some());
  }

  SceneGeometry geometry;
  TriangleTree tree;
  RoomField field;
};

/// A long bar with a hole, whose box is far from a cube; a ball of many triangles; a sheet that bounds no
/// solid.
std::vector<Scene> scenes() {
  const Mesh tool = solids::cylinder(0.004, 0.03, 24, 4);
  Mesh sheet = solids::box(Vec3(-0.05), Vec3(0.05), Int3(4));
  sheet.triangles.resize(sheet.triangles.size() / 6);
  std::vector<Scene> out;
  out.emplace_back(solids::ring(0.006, 0.02, 0.3, 48, 6), tool);
  out.emplace_back(solids::sphere(0.05, 60, 30), tool);
  out.emplace_back(sheet, tool);
  return out;
}

std::array<double, 3> array_of(const Vec3& p) { return {p.x, p.y, p.z}; }

constexpr double kAcross = 1.7320508075688772;  // a cube's diagonal, in its sides

TEST(DistanceLattice, PromisesNoMoreThanIsThereAndNearlyAsMuch) {
  equivalence::Random random(5);
  for (const Scene& scene : scenes()) {
    const double margin = 0.4 * scene.longest();
    const DistanceLattice lattice(scene.geometry.mockup, scene.tree, margin);
    ASSERT_LE(lattice.bytes(), sizeof(float) * DistanceLattice::kMostNodes);
    // Nodes are `spacing` apart: with two more along each axis they are no more than there may be, and with
    // a twentieth less between them they would be.
    const Vec3 side = scene.high() - scene.low() + Vec3(2 * margin);
    double spacing = std::cbrt(side.x * side.y * side.z / DistanceLattice::kMostNodes);
    while ((side.x / spacing + 2) * (side.y / spacing + 2) * (side.z / spacing + 2) >
           DistanceLattice::kMostNodes)
      spacing *= 1.01;
    spacing *= 1.05;
    for (int i = 0; i < 1500; ++i) {
      const Vec3 p = scene.place(random, i % 3 == 0 ? 3 : 0.4);
      const double distance = scene.distance(p), squared = lattice.squared(array_of(p));
      ASSERT_LE(std::sqrt(squared), distance);
      // Beyond its box, which may end a node further out: as far as the nearest place in it and that one's
      // distance, squared. No node of a cube is nearer than a diagonal less, and its middle loses 3/4 of a
      // square.
      const Vec3 within = glm::clamp(p, scene.low() - Vec3(margin), scene.high() + Vec3(margin));
      const double away = std::max(glm::length(p - within) - kAcross * spacing, 0.0),
                   node = std::max(scene.distance(within) - 2 * kAcross * spacing, 0.0);
      ASSERT_GE(squared,
                (away * away + std::max(node * node - 0.75 * spacing * spacing, 0.0)) * (1 - 0x1p-20) - 1);
    }
  }
}

TEST(RoomField, PromisesNoMoreThanIsThereAndNearlyAsMuch) {
  equivalence::Random random(6);
  for (const Scene& scene : scenes()) {
    const double cell = scene.field.cell_steps();
    EXPECT_EQ(scene.field.detail_steps(), 8 * cell);
    std::size_t near = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = i % 3 == 0 ? scene.place(random, i % 2 == 0 ? 0 : 2)
                                : scene.near_surface(random, (i % 2 == 0 ? 2 : 10) * cell);
      const double distance = scene.distance(p), room = scene.field.room_at(array_of(p));
      ASSERT_LE(room, distance);
      if (!scene.holds(p)) continue;
      // A cell and a touched one are as far apart as places in them are, but for both diagonals; a sixteenth
      // is lost in rounding. Beyond eight cells no more is promised here.
      if (distance < 8 * cell) ++near;
      ASSERT_GE(room, std::min(distance, 8 * cell) - (2 * kAcross + 1.0 / 16) * cell - 1);
    }
    EXPECT_GT(near, 200u);
  }
}

/// Whoever first comes to a brick works it out, also where several do at once.
TEST(RoomField, SaysTheSameToThreadsThatComeAtOnce) {
  equivalence::Random random(9);
  for (const Scene& scene : scenes()) {
    std::vector<std::array<double, 3>> places;
    for (int i = 0; i < 2000; ++i)
      places.push_back(array_of(scene.near_surface(random, 8 * scene.field.cell_steps())));
    std::vector<double> alone;
    for (const auto& place : places) alone.push_back(scene.field.room_at(place));
    for (int again = 0; again < 4; ++again) {
      const RoomField fresh = RoomField::of(scene.geometry, scene.tree);
      std::vector<std::vector<double>> told(4);
      std::vector<std::thread> threads;
      for (std::vector<double>& own : told)
        threads.emplace_back([&] {
          for (const auto& place : places) own.push_back(fresh.room_at(place));
        });
      for (std::thread& thread : threads) thread.join();
      for (const std::vector<double>& own : told) EXPECT_EQ(own, alone);
    }
  }
}

/// The tool's spheres at poses near and far, turned as in single precision.
TEST(RoomField, OfSpheresHoldsForAllTheirTriangles) {
  equivalence::Random random(7);
  const auto some = [&] { return 2 * random.unit() - 1; };
  for (const Scene& scene : scenes()) {
    const SceneGeometry& geometry = scene.geometry;
    const TriangleTree tool = TriangleTree::make(
        geometry.tool, [] { return true; }, kTriangleCollapsed);
    const ToolSpheres spheres(geometry.tool, tool);
    const double cell = scene.field.cell_steps();
    for (int i = 0; i < 60; ++i) {
      const double far = i % 3 == 0 ? 0.02 : i % 3 == 1 ? 0.1 : 1;
      const auto pose = to_lattice(
          {far * Vec3(some(), some(), some()), rotation_by(3.0 * Vec3(some(), some(), some()))}, geometry);
      ASSERT_TRUE(pose);
      const RoomField::Turn turn = scene.field.turn(*pose, geometry.tool_radius);
      for (std::uint32_t level = 0; level <= spheres.top(); ++level) {
        EightFloats squared;
        const auto number = static_cast<std::uint32_t>(
            random.below((tool.order.size() >> 3 * level) / kLanes + (level == spheres.top() ? 1 : 0) +
                         ((tool.order.size() >> 3 * level) < kLanes ? 1 : 0)));
        const EightSpheres& eight = spheres.group(level, level == spheres.top() ? 0 : number);
        scene.field.rooms(turn, eight, squared);
        for (std::size_t s = 0; s < kLanes; ++s) {
          if (eight.centre[0][s] == kNoSphere) continue;
          const double radius = eight.radius[s], room = scene.field.room(turn, squared[s], eight.radius[s]),
                       further = scene.field.far_room(turn, eight, s, squared[s]);
          // The exact place of the middle.
          Vec3 middle;
          for (int r = 0; r < 3; ++r) {
            double sum = pose->translation[r];
            for (int c = 0; c < 3; ++c)
              sum += pose->rotation_q30[r][c] * 0x1p-30 *
                     static_cast<double>(eight.centre[static_cast<std::size_t>(c)][s]);
            middle[r] = sum;
          }
          const std::array<double, 3> told = scene.field.centre(turn, eight, s);
          EXPECT_LE(glm::length(middle - Vec3(told[0], told[1], told[2])), turn.slack);
          const double distance = scene.distance(middle);
          ASSERT_LE(room + radius, distance);
          ASSERT_LE(further + radius, distance);
          ASSERT_GE(further, room - 1);
          if (scene.holds(middle)) {
            ASSERT_GE(room + radius, std::min(distance, 8 * cell) * (1 - 0x1p-19) -
                                         (2 * kAcross + 1.0 / 16) * cell - 2 * turn.slack - 2);
          }
        }
      }
    }
  }
}

TEST(RoomField, TellsWholeTrianglesApart) {
  equivalence::Random random(8);
  for (const Scene& scene : scenes()) {
    const double cell = scene.field.cell_steps();
    std::size_t beyond = 0, surely = 0;
    for (int i = 0; i < 1500; ++i) {
      const double size = cell * std::pow(2, random.between(-3, 2));
      const Vec3 at = scene.near_surface(random, 6 * cell);
      exact::Corners triangle;
      for (int c = 0; c < 3; ++c)
        triangle[static_cast<std::size_t>(c)] =
            Int3(at + size * Vec3{random.unit(), random.unit(), random.unit()});
      const double steps = (random.below(3) == 0 ? 8 : cell * random.unit());
      const bool told = scene.field.all_beyond(triangle, steps);
      const double corner = scene.distance(Vec3(triangle[0]));
      surely += corner > steps + kAcross * size ? 1u : 0u;
      if (told) {
        ++beyond;
        constexpr int kParts = 4;  // places of the triangle, its corners and edges among them
        for (int a = 0; a <= kParts; ++a)
          for (int b = 0; a + b <= kParts; ++b)
            ASSERT_GT(scene.distance((Vec3(triangle[0]) * double(a) + Vec3(triangle[1]) * double(b) +
                                      Vec3(triangle[2]) * double(kParts - a - b)) /
                                     double(kParts)),
                      steps);
      } else if (size < cell) {
        // A ball about a place of it is no further from all of it than it is long.
        ASSERT_LE(std::min(corner, 8 * cell),
                  steps + 2 * kAcross * size + (2 * kAcross + 1.0 / 16) * cell + 2);
      }
    }
    EXPECT_GT(beyond, surely / 4);  // chosen: balls and cells that are no use tell next to none
  }
}

}  // namespace
}  // namespace palpate::native
