#include "model/mesh/thicken.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

/// Parts cover all triangles, and every edge is run along as often one way as the other, place by place.
void expect_closed(const Mesh& mesh) {
  std::uint32_t covered = 0;
  for (const MeshPart& part : mesh.parts) {
    EXPECT_EQ(part.first_triangle, covered);
    covered += part.triangle_count;
  }
  EXPECT_EQ(covered, mesh.triangles.size());
  std::map<std::pair<std::array<double, 3>, std::array<double, 3>>, int> runs;
  const auto key = [&](std::uint32_t v) {
    return std::array{mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z};
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = key(t[k]), b = key(t[(k + 1) % 3]);
      runs[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, count] : runs) EXPECT_EQ(count, 0);
}

double volume_of(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    six += glm::dot(mesh.vertices[a], glm::cross(mesh.vertices[b], mesh.vertices[c]));
  return six / 6;
}

Mesh of(std::vector<Vec3> vertices, std::vector<std::array<std::uint32_t, 3>> triangles) {
  Mesh mesh{std::move(vertices), std::move(triangles), {}};
  mesh.parts = {{"sheet", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

/// Three corners of its own for every triangle, as STL files have them.
Mesh torn(const Mesh& mesh) {
  Mesh out{{}, {}, mesh.parts};
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::uint32_t v : t) out.vertices.push_back(mesh.vertices[v]);
    out.triangles.push_back({first, first + 1, first + 2});
  }
  return out;
}

/// A square of side 1 in z = 0, facing up, of n × n cells.
Mesh square(std::uint32_t n) {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) vertices.emplace_back(double(i) / n, double(j) / n, 0);
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      triangles.push_back({a, b, b + 1});
      triangles.push_back({a, b + 1, a + 1});
    }
  return of(std::move(vertices), std::move(triangles));
}

TEST(Thicken, AFlatSheetIsABox) {
  const Mesh sheet = square(4);
  for (const Mesh& mesh : {sheet, torn(sheet), solids::turned_inside_out(sheet)}) {
    const Thickened thick = thicken(mesh, 0.1);
    EXPECT_EQ(thick.walls, 32u);
    // 32 fronts, as many backs, two triangles on each of 16 borders.
    EXPECT_EQ(thick.mesh.triangles.size(), 96u);
    expect_closed(thick.mesh);
    EXPECT_NEAR(volume_of(thick.mesh), 0.1, 1e-15);
    for (std::size_t t = 0; t < 64; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(std::abs(thick.mesh.vertices[thick.mesh.triangles[t][k]].z), 0.05, 1e-15);
    // Front i lies over triangle i, back i under it.
    for (std::uint32_t t = 0; t < 32; ++t)
      for (const std::uint32_t i : {t, t + 32}) {
        Vec3 middle(0), wanted(0);
        for (std::size_t k = 0; k < 3; ++k) {
          middle += thick.mesh.vertices[thick.mesh.triangles[i][k]] / 3.0;
          wanted += mesh.vertices[mesh.triangles[t][k]] / 3.0;
        }
        EXPECT_NEAR(middle.x, wanted.x, 1e-15);
        EXPECT_NEAR(middle.y, wanted.y, 1e-15);
      }
  }
}

TEST(Thicken, HowTrianglesAreTurnedDoesNotMatter) {
  std::mt19937 random(3);
  Mesh mesh = square(6);
  for (auto& t : mesh.triangles)
    if (random() % 2 == 0) std::swap(t[1], t[2]);
  const Thickened thick = thicken(mesh, 0.05);
  EXPECT_EQ(thick.mesh.triangles.size(), 2u * 72 + 2 * 24);
  expect_closed(thick.mesh);
  EXPECT_NEAR(std::abs(volume_of(thick.mesh)), 0.05, 1e-14);
}

TEST(Thicken, WhatIsClosedStaysAsItIs) {
  Mesh mesh = solids::box(Vec3(0), Vec3(1));
  EXPECT_EQ(thicken(mesh, 0.1).walls, 0u);
  const auto closed = mesh.triangles.size();
  const Mesh sheet = square(2);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& v : sheet.vertices) mesh.vertices.push_back(v + Vec3(0, 0, 3));
  for (const auto& [a, b, c] : sheet.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  mesh.parts = {{"box and one triangle", 0, 13}, {"the rest", 13, 7}};
  const Thickened thick = thicken(mesh, 0.1);
  EXPECT_EQ(thick.walls, 8u);
  for (std::size_t t = 0; t < closed; ++t)
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_EQ(thick.mesh.vertices[thick.mesh.triangles[t][k]], mesh.vertices[mesh.triangles[t][k]]);
  ASSERT_EQ(thick.mesh.parts.size(), 2u);
  EXPECT_EQ(thick.mesh.parts[1].path, "the rest");
  expect_closed(thick.mesh);
  EXPECT_NEAR(volume_of(thick.mesh), 1 + 0.1, 1e-14);
}

// Between the polygons' corners at r ± t/2·(their mitre): area of a ring times its length.
TEST(Thicken, ATubeHasItsWall) {
  constexpr double kRadius = 0.4, kLength = 2, kThick = 0.05;
  constexpr std::uint32_t kSides = 24;
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    for (const double z : {0.0, kLength})
      vertices.emplace_back(kRadius * std::cos(angle), kRadius * std::sin(angle), z);
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    triangles.push_back({a, b, b + 1});
    triangles.push_back({a, b + 1, a + 1});
  }
  const Thickened thick = thicken(of(std::move(vertices), std::move(triangles)), kThick);
  expect_closed(thick.mesh);
  // Walls of flat plates kThick thick all round: a polygon's area grows with the square of its radius.
  const double step = 2 * std::numbers::pi / kSides, mitre = kThick / 2 / std::cos(step / 2),
               area = kSides / 2.0 * std::sin(step) *
                      ((kRadius + mitre) * (kRadius + mitre) - (kRadius - mitre) * (kRadius - mitre));
  // Angles at the tube's ends weigh its sides unequally there, so corners lean by what a mitre is: (1/cos −
  // 1).
  EXPECT_NEAR(volume_of(thick.mesh), area * kLength, area * kLength * (1 / std::cos(step / 2) - 1));
}

TEST(Thicken, EdgesOfThreeTrianglesAndStripsOfOneSideBecomeClosed) {
  // Three squares on one edge, as ribs.
  Mesh ribs;
  ribs.vertices = {Vec3(0, 0, 0), Vec3(0, 0, 1)};
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * std::numbers::pi * i / 3;
    const auto first = static_cast<std::uint32_t>(ribs.vertices.size());
    ribs.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    ribs.vertices.emplace_back(std::cos(angle), std::sin(angle), 1);
    ribs.triangles.push_back({0, first, first + 1});
    ribs.triangles.push_back({0, first + 1, 1});
  }
  ribs.parts = {{"ribs", 0, 6}};
  Thickened thick = thicken(ribs, 0.02);
  expect_closed(thick.mesh);
  EXPECT_NEAR(std::abs(volume_of(thick.mesh)), 3 * 0.02, 1e-12);

  constexpr std::uint32_t kSteps = 40;
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    const double along = 2 * std::numbers::pi * i / kSteps, twist = along / 2;
    for (const double w : {-0.2, 0.2})
      vertices.emplace_back((1 + w * std::cos(twist)) * std::cos(along),
                            (1 + w * std::cos(twist)) * std::sin(along), w * std::sin(twist));
    const bool last = i + 1 == kSteps;  // comes round turned over
    const std::uint32_t a = 2 * i, b = last ? 1 : a + 2, c = last ? 0 : a + 3;
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, a + 1});
  }
  thick = thicken(of(std::move(vertices), std::move(triangles)), 0.01);
  EXPECT_EQ(thick.walls, 2 * kSteps);
  expect_closed(thick.mesh);
  // 2π long, 0.4 wide; its twist adds the mean of w²/8, 0.2 %, and 40 chords take 0.1 % off. From one
  // triangle to the next it bends by up to 9° and twists by 4.5°, and corners go as far out as mitres of that
  // do.
  const double plates = 2 * std::numbers::pi * 0.4 * 0.01, volume = std::abs(volume_of(thick.mesh));
  EXPECT_GT(volume, 0.995 * plates);
  EXPECT_LT(volume, 1.005 * plates / std::cos(13.5 / 180 * std::numbers::pi));
}

/// The sides of a cube of side 1 about the origin, all but `without`, each a little smaller than it; some
/// turned over.
Mesh cube_with_gaps(int without) {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      if (2 * axis + (side > 0 ? 1 : 0) == without) continue;
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const auto& [u, v] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
        Vec3 p(0);
        p[axis] = 0.5 * side;
        p[(axis + 1) % 3] = 0.4999 * u;
        p[(axis + 2) % 3] = 0.4999 * v;
        mesh.vertices.push_back(p);
      }
      const bool over = (axis + side) % 2 == 0;
      mesh.triangles.push_back({first, first + (over ? 2U : 1U), first + (over ? 1U : 2U)});
      mesh.triangles.push_back({first, first + (over ? 3U : 2U), first + (over ? 2U : 3U)});
    }
  mesh.parts = {{"cube", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

void add(const Mesh& other, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  mesh.parts = {{"all", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
}

Thickened thickened_but_insides(const Mesh& mesh) {
  auto enclosure = Enclosure::of(mesh);
  EXPECT_TRUE(enclosure) << enclosure.error().sentence;
  return thicken(mesh, 0.01, &*enclosure);
}

TEST(Thicken, OpenPiecesThatBoundAnInsideAreSpared) {
  Mesh mesh = cube_with_gaps(-1);
  EXPECT_EQ(thicken(mesh, 0.01).walls, 12u);
  EXPECT_EQ(thickened_but_insides(mesh).walls, 0u);
  EXPECT_EQ(thickened_but_insides(mesh).spared, 12u);
  add(cube_with_gaps(-1), mesh);  // once more in the same place
  EXPECT_EQ(thickened_but_insides(mesh).spared, 12u);
  EXPECT_EQ(thickened_but_insides(mesh).copies, 12u);
  // A sheet in it, and one beside it, are walls all the same.
  for (const double x : {-0.2, 3.0}) {
    Mesh sheet = square(2);
    for (Vec3& v : sheet.vertices) v = 0.4 * v + Vec3(x, -0.2, 0);
    add(sheet, mesh);
  }
  EXPECT_EQ(thickened_but_insides(mesh).walls, 16u);
  EXPECT_EQ(thickened_but_insides(mesh).spared, 12u);
  // Without its lid a box is a shell.
  EXPECT_EQ(thickened_but_insides(cube_with_gaps(5)).walls, 10u);
}

// Seen from the point of a ball opposite to a hole, the hole fills 2π (1 − cos) of half its angle.
TEST(Thicken, EnclosureOfABallWithAHole) {
  constexpr double kOff = 0.05;  // as winding_number_test has it
  double before = 0.5;           // of a closed ball; a larger hole leaves less
  for (const double angle : {0.3, 0.8, 1.1}) {
    Mesh ball = solids::sphere(1, 96, 48);
    std::erase_if(ball.triangles, [&](const auto& t) {
      const Vec3 middle = (ball.vertices[t[0]] + ball.vertices[t[1]] + ball.vertices[t[2]]) / 3.0;
      return middle.z > std::cos(angle) * glm::length(middle);
    });
    ball.parts = {{"ball", 0, static_cast<std::uint32_t>(ball.triangles.size())}};
    const auto enclosure = Enclosure::of(ball);
    ASSERT_TRUE(enclosure);
    int asked = 0;
    double sum = 0;
    for (std::uint32_t t = 0; t < ball.triangles.size(); ++t) {
      const Vec3 middle = (ball.vertices[ball.triangles[t][0]] + ball.vertices[ball.triangles[t][1]] +
                           ball.vertices[ball.triangles[t][2]]) /
                          3.0;
      if (middle.z > -0.99) continue;
      ++asked;
      sum += enclosure->at(t);
      EXPECT_NEAR(enclosure->at(t), 0.5 - (1 - std::cos(angle / 2)) / 2, kOff) << angle;
    }
    ASSERT_GT(asked, 0);
    EXPECT_LT(sum / asked, before);
    before = sum / asked;
  }
}

TEST(Thicken, WhatIsThereTwiceIsOneWall) {
  Mesh twice = square(2);
  const Mesh once = twice;
  for (const auto& t : once.triangles) twice.triangles.push_back({t[0], t[2], t[1]});
  twice.parts.front().triangle_count = 16;
  const Thickened thick = thicken(twice, 0.1);
  EXPECT_EQ(thick.copies, 8u);
  expect_closed(thick.mesh);
  EXPECT_NEAR(std::abs(volume_of(thick.mesh)), 0.1, 1e-15);
}

// Chance: heaps of triangles between few points, many of them on one edge.
TEST(Thicken, WhateverHangsTogetherBecomesClosed) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> points(8);
    std::uniform_real_distribution<double> place(-1, 1);
    for (Vec3& p : points) p = Vec3(place(random), place(random), place(random));
    std::vector<std::array<std::uint32_t, 3>> triangles(1 + random() % 16);
    for (auto& t : triangles)
      for (std::uint32_t& v : t) v = static_cast<std::uint32_t>(random() % points.size());
    const Mesh mesh = of(points, triangles);
    Thickened thick = thicken(mesh, 0.01);
    // Flat ones stay and belong to nothing.
    std::erase_if(thick.mesh.triangles,
                  [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[0] == t[2]; });
    thick.mesh.parts.front().triangle_count = static_cast<std::uint32_t>(thick.mesh.triangles.size());
    expect_closed(thick.mesh);
  }
}

}  // namespace
}  // namespace palpate
