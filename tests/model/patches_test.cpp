// Patches are about the faces that a CAD file knows, and no face is too small or too thin for the pressure
// field.
#include "model/mesh/patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include "cpu_ref/exact.h"
#include "cpu_ref/samples.h"
#include "model/generate/solids.h"
#include "model/lattice/triangle.h"
#include "model/mesh/mass.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

constexpr double kStep = 0x1p-20;                        // m, about a micrometre
constexpr std::int32_t kSpacing = 1468;                  // 1.4 mm
constexpr double kSquare = double{kSpacing} * kSpacing;  // steps²

LatticeMesh build(const Mesh& mesh, const Vec3& origin_m = Vec3(0), std::int32_t spacing = kSpacing) {
  MeshReport report;
  auto built = build_lattice_mesh(mesh, Lattice{kStep, origin_m}, {}, report);
  EXPECT_TRUE(built) << built.error().sentence;
  weigh_for_field(spacing, find_tips(spacing, *built), *built);
  return std::move(*built);
}

double area_of(const LatticeMesh& mesh, std::uint32_t triangle) {
  return glm::length(Vec3(raw_normal(mesh, triangle))) / 2;
}
Vec3 normal_of(const LatticeMesh& mesh, std::uint32_t triangle) {
  return Vec3(mesh.unit_normal_q30[triangle]) * 0x1p-30;
}

/// What the field sees of the surface, s² w.
struct Seen {
  double area = 0;
  Vec3 normal{0};          ///< Σ s² w n̂: 0 for a closed surface
  double patch_worst = 0;  ///< largest difference from a patch's area
};
Seen seen(const LatticeMesh& mesh, std::int32_t spacing = kSpacing) {
  Seen out;
  std::vector<double> true_area(mesh.patch_count, 0), patch_area(mesh.patch_count, 0);
  const double square = double{1} * spacing * spacing * 0x1p-30;
  const auto add = [&](std::uint32_t t, double weight) {
    out.area += square * weight;
    out.normal += square * weight * normal_of(mesh, t);
    patch_area[mesh.patch[t]] += square * weight;
  };
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.collapsed(t)) continue;
    true_area[mesh.patch[t]] += area_of(mesh, t);
    add(t, count_samples(mesh, t, spacing)[0] * mesh.field_weight_q30[t]);
  }
  for (const ExtraSample& extra : mesh.extra_samples) add(extra.triangle, extra.weight_q30);
  for (std::size_t p = 0; p < true_area.size(); ++p)
    out.patch_worst = std::max(out.patch_worst, std::abs(patch_area[p] - true_area[p]));
  return out;
}

/// A needle along −z with a flat end, its tip at z = 0.
Mesh needle(double tip_radius, double radius, double length) {
  return solids::revolve({{tip_radius, 0}, {radius, length / 4}, {radius, length}}, 24,
                         solids::Ends::kPoints);
}

TEST(Patches, ACubeHasSixAndACylinderThree) {
  const LatticeMesh cube = build(solids::box(Vec3(0), Vec3(0.02), Int3(3)));
  EXPECT_EQ(cube.patch_count, 6u);
  EXPECT_EQ(build(solids::cylinder(0.01, 0.03, 48, 2)).patch_count, 3u);
  EXPECT_EQ(build(solids::cylinder(0.01, 0.03, 8)).patch_count,
            10u);  // 45° from side to side: no longer round
  EXPECT_EQ(build(solids::sphere(0.01)).patch_count, 1u);
  for (std::uint32_t t = 0; t < cube.triangles.size(); ++t)
    for (std::uint32_t other = 0; other < t; ++other)
      EXPECT_EQ(cube.patch[t] == cube.patch[other], cube.unit_normal_q30[t] == cube.unit_normal_q30[other]);
}

TEST(Patches, AreNumberedByTheirSmallestTriangleAndLeaveCollapsedOnesOut) {
  Mesh mesh = solids::cylinder(0.01, 0.03, 48);
  mesh.vertices.push_back(mesh.vertices[mesh.triangles[5][0]]);
  const auto twice = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  mesh.triangles.insert(mesh.triangles.begin(), {mesh.triangles[5][0], twice, mesh.triangles[5][1]});
  mesh.parts.clear();
  const LatticeMesh built = build(mesh);
  ASSERT_TRUE(built.collapsed(0));
  EXPECT_EQ(built.patch[0], kNoPatch);
  EXPECT_EQ(built.field_weight_q30[0], 0u);
  std::uint32_t next = 0;
  for (std::uint32_t t = 1; t < built.triangles.size(); ++t) {
    ASSERT_LE(built.patch[t], next);
    if (built.patch[t] == next) ++next;
  }
  EXPECT_EQ(next, built.patch_count);
  EXPECT_EQ(next, 3u);
}

TEST(Patches, EndWhereAPartEnds) {
  Mesh two;
  solids::append(two, solids::box(Vec3(0), Vec3(0.02)), "left");
  solids::append(two, solids::box(Vec3(0.02, 0, 0), Vec3(0.04, 0.02, 0.02)), "right");  // flush with it
  EXPECT_EQ(build(two).patch_count, 12u);
  two.parts = {{"both", 0, 24}};
  EXPECT_LT(build(two).patch_count, 12u);
}

TEST(FieldWeights, CountTheSamplesThatTheReferenceVisitsLevelByLevel) {
  std::mt19937 random(7);
  double total = 0;
  for (const std::int32_t spacing : {1, 3, 8}) {
    for (int i = 0; i < 3000; ++i) {
      // Few coordinates, many of them on the grid: ties of every kind.
      std::uniform_int_distribution<std::int32_t> coordinate(-24, 24);
      LatticeMesh mesh;
      for (int k = 0; k < 3; ++k)
        mesh.vertices.emplace_back(coordinate(random), coordinate(random), coordinate(random));
      mesh.triangles = {{0, 1, 2}};
      const Long3 raw = raw_normal(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]);
      mesh.flags = {static_cast<std::uint8_t>(raw == Long3(0) ? kTriangleCollapsed : 0)};
      mesh.sample_axis = {static_cast<std::uint8_t>(dominant_axis(raw))};
      mesh.unit_normal_q30 = {Int3(raw)};
      cpu_ref::Box everywhere;
      everywhere.min = Int3(-100);
      everywhere.max = Int3(100);
      std::array<double, kSampleLevels + 1> visited{};
      cpu_ref::for_each_sample(mesh, 0, spacing, everywhere, [&](const Int3& p) {
        const auto cell = [&](int k) {
          return static_cast<std::int64_t>(std::floor(static_cast<double>(p[k]) / spacing));
        };
        const int axis = mesh.sample_axis[0];
        for (int level = cpu_ref::level_of({cell((axis + 1) % 3), cell((axis + 2) % 3)}); level >= 0; --level)
          visited[static_cast<std::size_t>(level)] += 1;
      });
      ASSERT_EQ(count_samples(mesh, 0, spacing), visited) << spacing << " " << i;
      total += visited[0];
    }
  }
  EXPECT_GT(total, 100000);
}

// Of a triangle of 2^22 cells the samples are not counted one by one; its border is 10^4 cells long, so that
// is right to a 400th.
TEST(FieldWeights, CountTheSamplesOfAVastTriangleByItsArea) {
  LatticeMesh mesh;
  mesh.vertices = {Int3(0), Int3(0, 2048 * 64, 0), Int3(0, 0, 2048 * 64)};
  mesh.triangles = {{0, 1, 2}};
  mesh.flags = {0};
  mesh.sample_axis = {0};
  mesh.unit_normal_q30 = {Int3(1 << 30, 0, 0)};
  const auto counted = count_samples(mesh, 0, 64);
  for (int level = 0; level <= kSampleLevels; ++level)
    EXPECT_EQ(counted[static_cast<std::size_t>(level)], std::ldexp(2048.0 * 2048 / 2, -level));
  double visited = 0;
  cpu_ref::Box everywhere;
  everywhere.min = Int3(-1);
  everywhere.max = Int3(1 << 20);
  cpu_ref::for_each_sample(mesh, 0, 64, everywhere, [&](const Int3&) { visited += 1; });
  EXPECT_NEAR(visited, counted[0], counted[0] / 400);
}

TEST(FieldWeights, CountOfATriangleTheSamplesThatWeighSomething) {
  // A ball, whose samples the grid has, with a pin that extra samples stand for.
  Mesh both = solids::sphere(0.03, 48, 24);
  solids::append(both, solids::moved(solids::cylinder(0.0004, 0.02, 8), {Vec3(0.1, 0, 0), Quat(1, 0, 0, 0)}),
                 "pin");
  LatticeMesh mesh = build(both);
  count_grid_samples(kSpacing, mesh);
  ASSERT_EQ(mesh.grid_samples.size(), mesh.triangles.size());
  cpu_ref::Box everywhere;
  everywhere.min = Int3(-(1 << 20));
  everywhere.max = Int3(1 << 20);
  std::uint64_t counted = 0, weightless = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t visited = 0;
    cpu_ref::for_each_sample(mesh, t, kSpacing, everywhere, [&](const Int3&) { ++visited; });
    if (mesh.field_weight_q30[t] == 0) weightless += std::exchange(visited, 0);
    ASSERT_EQ(mesh.grid_samples[t], visited) << t;
    counted += visited;
  }
  EXPECT_GT(counted, 3000);
  EXPECT_GT(weightless, 0);
}

/// The largest and the smallest number of samples that lie in a strip of `width` × `length` steps along an
/// axis, wherever it begins.
std::pair<double, double> in_strips(std::int32_t width, std::int32_t length, bool along_u, int level,
                                    std::int32_t spacing) {
  std::vector<Int3> all;
  cpu_ref::Box everywhere;
  everywhere.min = Int3(-(1 << 22));
  everywhere.max = Int3(1 << 22);
  LatticeMesh mesh;
  const std::int32_t far = 2 * length;
  mesh.vertices = {Int3(0, -far, -far), Int3(0, 3 * far, -far), Int3(0, -far, 3 * far)};
  mesh.triangles = {{0, 1, 2}};
  mesh.flags = {0};
  mesh.sample_axis = {0};
  mesh.unit_normal_q30 = {Int3(1 << 30, 0, 0)};
  cpu_ref::for_each_sample(mesh, 0, spacing, everywhere, [&](const Int3& p) {
    if (cpu_ref::level_of({cpu_ref::floor_divide(std::int64_t{p.y}, std::int64_t{spacing}),
                           cpu_ref::floor_divide(std::int64_t{p.z}, std::int64_t{spacing})}) >= level)
      all.push_back(p);
  });
  std::pair<double, double> out{0, 1e9};
  for (std::int32_t from = -length; from < length; from += width / 5 + 1) {
    double count = 0;
    for (const Int3& p : all) {
      const std::int32_t across = along_u ? p.z : p.y, along = along_u ? p.y : p.z;
      count += across >= from && across < from + width && along >= 0 && along < length ? 1 : 0;
    }
    out.first = std::max(out.first, count);
    out.second = std::min(out.second, count);
  }
  return out;
}

// A strip of a fifth of a cell, 40 cells long, should hold 8 samples at level 0, where a square grid has 40
// or none. Of n multiples of the golden ratio in a row an interval's share is off by less than 3 (its
// discrepancy: 1 + log n / log of the ratio, over 3, rounded up): 5 to 11. Coarser levels choose among few
// places in a block, and are asked for some and no more than three times their share (chosen).
TEST(SampleGrid, AStripAlongAnAxisHoldsItsShareOfSamplesAtEveryLevel) {
  constexpr std::int32_t kCell = 1000;
  for (const bool along_u : {false, true})
    for (int level = 0; level <= kSampleLevels; ++level) {
      const std::int32_t cell = kCell << level / 2;  // of the level's own; on a chessboard half as many
      const double share = level % 2 == 0 ? 8 : 4;
      const auto [most, least] = in_strips(cell / 5, 40 * cell, along_u, level, kCell);
      EXPECT_LE(most, level == 0 ? 11 : 3 * share) << level;
      EXPECT_GE(least, level == 0 ? 5 : 1) << level;
    }
}

TEST(FieldWeights, ANeedlesTipHasExtraSamplesOfItsArea) {
  for (int i = 0; i < 10; ++i) {
    const LatticeMesh mesh = build(needle(0.0002, 0.0005, 0.04), {0.00131 * i, 0.00117 * i, 0.0003});
    double area = 0;
    std::uint32_t tip = kNoPatch;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      if (normal_of(mesh, t).z > -0.99) continue;
      tip = mesh.patch[t];
      area += area_of(mesh, t);
    }
    ASSERT_NE(tip, kNoPatch);
    double felt = 0;
    for (const ExtraSample& extra : mesh.extra_samples)
      if (mesh.patch[extra.triangle] == tip) felt += extra.weight_q30 * 0x1p-30 * kSquare;
    EXPECT_NEAR(felt, area, 0.05);  // of up to 24 weights, each half a Q30 of s²
  }
}

// Weights are whole 2^-30ths of s² = 2.1e6 steps²: a sample is off by 0.001 steps² at most.
TEST(FieldWeights, EveryPatchOfASmallBodyIsSeenAsLargeAsItIs) {
  for (int i = 0; i < 20; ++i) {
    const Vec3 at(0.00131 * i, 0.00117 * i, 0.00071 * i);
    for (const double size : {0.0004, 0.0015, 0.005, 0.01}) {
      const LatticeMesh box = build(solids::box(at, at + Vec3(size, 0.7 * size, 1.1 * size)));
      const Seen whole = seen(box);
      EXPECT_LT(whole.patch_worst, 1) << i << " " << size;
      EXPECT_NEAR(whole.area, measure(box).area, 1);
    }
    const LatticeMesh sphere = build(solids::sphere(0.002), at);
    EXPECT_LT(seen(sphere).patch_worst, 1);
  }
}

// A side's weights make up for what its border adds or takes: of 5,000 samples, 4 × 70 at the border, a
// hundredth at most.
TEST(FieldWeights, OfLargeFacesAreNearlyTheGrids) {
  const LatticeMesh box = build(solids::box(Vec3(0.001), Vec3(0.1), Int3(2)));
  for (std::uint32_t t = 0; t < box.triangles.size(); ++t)
    EXPECT_NEAR(static_cast<double>(box.field_weight_q30[t]) / box.sample_weight_q30[t], 1, 0.01);
  EXPECT_TRUE(box.extra_samples.empty());
}

// The push of a pressure that is the same everywhere, nothing all in all. A side, a quarter of the mantle, is
// off by a sixteenth of its area at most; three sides look the way of an axis at least in part, and a shadow
// is 1/π of the mantle: 3/64 π = 15 % of it.
TEST(FieldWeights, OfAThinPinCancel) {
  for (int i = 0; i < 20; ++i) {
    const LatticeMesh pin = build(solids::cylinder(0.0005, 0.05), {0.00131 * i, 0.00117 * i, 0.00071 * i});
    const Seen whole = seen(pin);
    const double area = measure(pin).area;
    EXPECT_NEAR(whole.area, area, 0.001 * static_cast<double>(pin.extra_samples.size())) << i;
    EXPECT_LT(glm::length(whole.normal), area / 16) << i;
    // Pressed from any side it is felt: a quarter of the mantle looks each way.
    double away[6] = {};
    const auto add = [&](std::uint32_t t, double weight) {
      const Vec3 n = normal_of(pin, t);
      for (int k = 0; k < 3; ++k) away[2 * k + (n[k] > 0)] += kSquare * 0x1p-30 * weight * std::abs(n[k]);
    };
    for (std::uint32_t t = 0; t < pin.triangles.size(); ++t)
      add(t, count_samples(pin, t, kSpacing)[0] * pin.field_weight_q30[t]);
    for (const ExtraSample& extra : pin.extra_samples) add(extra.triangle, extra.weight_q30);
    const double shadow = 0.001 * 0.05 / kStep / kStep, end = shadow / 0.05 * 0.001 * 0.7854;
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(away[k], shadow, 0.15 * shadow) << i << " " << k;
    for (int k = 4; k < 6; ++k)
      EXPECT_NEAR(away[k], end, 0.01 * end) << i << " " << k;  // 48 sides: 0.3 % less than a circle
  }
}

TEST(FieldWeights, TheEdgeOfAThinSheetIsSeenAllAlong) {
  int missed = 0;
  for (int i = 0; i < 20; ++i) {
    const Vec3 at(0.00131 * i, 0.00117 * i, 0.00071 * i);
    const LatticeMesh sheet = build(solids::box(at, at + Vec3(0.4, 0.2, 0.0008)));
    const Seen whole = seen(sheet);
    EXPECT_LT(glm::length(whole.normal), 0.002 * measure(sheet).area);  // the large faces see the same grid
    for (const double side : {-1, 1}) {
      std::vector<double> along;
      for (const ExtraSample& extra : sheet.extra_samples)
        if (normal_of(sheet, extra.triangle).y * side > 0.9) along.push_back(extra.point.x * kStep - at.x);
      if (along.empty()) continue;
      ++missed;
      std::sort(along.begin(), along.end());
      for (std::size_t n = 1; n < along.size(); ++n) EXPECT_LT(along[n] - along[n - 1], 0.0014) << i;
      EXPECT_LT(along.front(), 0.0014);
      EXPECT_GT(along.back(), 0.4 - 0.0014);
    }
  }
  EXPECT_GT(missed, 5);
}

TEST(ExtraSamples, LieOnTheirTrianglesAndAscend) {
  std::size_t count = 0;
  for (int i = 0; i < 10; ++i) {
    Mesh turned = solids::moved(needle(0.0003, 0.0006, 0.05),
                                {Vec3(0.00131 * i, 0, 0), glm::normalize(Quat(1, 0.1 * i, 0.3, -0.2))});
    const LatticeMesh mesh = build(turned);
    count += mesh.extra_samples.size();
    std::uint32_t before = 0;
    for (const ExtraSample& extra : mesh.extra_samples) {
      EXPECT_GE(extra.triangle, before);
      EXPECT_GT(extra.weight_q30, 0u);
      before = extra.triangle;
      const Vec3 a(mesh.corner(extra.triangle, 0)), b(mesh.corner(extra.triangle, 1)),
          c(mesh.corner(extra.triangle, 2)), p(extra.point);
      const Vec3 n = glm::normalize(glm::cross(b - a, c - a));
      EXPECT_LT(std::abs(glm::dot(n, p - a)),
                std::sqrt(3.0));  // each component is rounded down by less than a step
      for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}})
        EXPECT_GT(glm::dot(glm::cross(n, glm::normalize(to - from)), p - from), -std::sqrt(3.0));
    }
  }
  EXPECT_GT(count, 20u);
}

// Of a long face of two triangles, what reaches in from either end meets as much of its samples as of its
// area: each triangle's strips are off by less than one. Strips' centroids have the face's own middle; each
// is rounded by half a step an axis.
TEST(ExtraSamples, OfALongFaceLieAsDenselyAtItsEndsAsInItsMiddle) {
  const double length = 0.04;
  const LatticeMesh rod = build(solids::box(Vec3(0), Vec3(0.0004, 0.0004, length), Int3(1)));
  int faces = 0;
  for (std::uint32_t patch = 0; patch < rod.patch_count; ++patch) {
    std::vector<std::pair<double, double>> along;  // place, weight
    double whole = 0, moment = 0;
    for (const ExtraSample& extra : rod.extra_samples) {
      if (rod.patch[extra.triangle] != patch) continue;
      if (std::abs(normal_of(rod, extra.triangle).z) > 0.5) continue;
      along.emplace_back(extra.point.z * kStep, extra.weight_q30);
      whole += along.back().second;
      moment += along.back().first * along.back().second;
    }
    if (along.empty()) continue;
    ++faces;
    ASSERT_GT(along.size(), 40u);
    EXPECT_NEAR(moment / whole, length / 2, 0.5 * kStep);
    for (double part = 0.05; part < 1; part += 0.05) {
      double before = 0;
      for (const auto& [z, weight] : along)
        if (z < part * length) before += weight;
      EXPECT_NEAR(before / whole, part, 2.0 / static_cast<double>(along.size())) << part;
    }
  }
  EXPECT_EQ(faces, 4);
}

// A fine comb: 0.3 mm teeth under samples 1.4 mm apart.
TEST(ExtraSamples, OfCoarserLevelsAreFewerAndStandForTheSameAreaPatchByPatch) {
  Mesh comb = needle(0.0003, 0.0006, 0.05);
  for (int i = 1; i < 8; ++i)
    solids::append(comb,
                   solids::moved(needle(0.0003, 0.0006, 0.05), {Vec3(0.002 * i, 0, 0), Quat(1, 0, 0, 0)}),
                   "tooth");
  const LatticeMesh mesh = build(comb);
  ASSERT_GT(mesh.extra_samples.size(), 200u);
  std::vector<double> area(mesh.patch_count, 0);
  for (const ExtraSample& extra : mesh.extra_samples)
    area[mesh.patch[extra.triangle]] += extra.weight_q30 * 0x1p-30;
  std::size_t before = mesh.extra_samples.size();
  for (int level = 1; level <= kSurfaceLevels; ++level) {
    std::vector<double> coarse(mesh.patch_count, 0);
    std::size_t count = 0;
    for (const ExtraSample& extra : mesh.extra_samples) {
      const std::uint32_t weight = extra.coarse_q30[static_cast<std::size_t>(level - 1)];
      coarse[mesh.patch[extra.triangle]] += std::ldexp(weight, level - 30);
      count += weight != 0 ? 1 : 0;
    }
    for (std::size_t p = 0; p < area.size(); ++p)
      EXPECT_NEAR(coarse[p], area[p], std::ldexp(static_cast<double>(before), level - 31))
          << "level " << level << ", patch " << p;  // each rounded by half a Q30
    EXPECT_LE(count, before);
    before = count;
  }
  EXPECT_LT(before, mesh.extra_samples.size() / 4);
}

TEST(ExtraSamples, OfOneLevelLieInTheCubesOfThoseTheyStandFor) {
  const LatticeMesh mesh = build(solids::moved(
      needle(0.0003, 0.0006, 0.05), {Vec3(0.0007, 0.0003, 0), glm::normalize(Quat(1, 0.3, 0.2, -0.1))}));
  std::vector<Int3> corner(mesh.patch_count, Int3(std::numeric_limits<std::int32_t>::max()));
  for (const ExtraSample& one : mesh.extra_samples)
    corner[mesh.patch[one.triangle]] = glm::min(corner[mesh.patch[one.triangle]], one.point);
  for (int level = 1; level <= kSurfaceLevels; ++level) {
    const int edge = kSpacing << level / 2;
    for (const ExtraSample& one : mesh.extra_samples) {
      bool stood_for = false;
      for (const ExtraSample& other : mesh.extra_samples) {
        if (other.coarse_q30[static_cast<std::size_t>(level - 1)] == 0 ||
            mesh.patch[other.triangle] != mesh.patch[one.triangle])
          continue;
        bool same = true;
        for (int k = 0; k < 3; ++k)
          same = same && (one.point - corner[mesh.patch[one.triangle]])[k] / edge ==
                             (other.point - corner[mesh.patch[one.triangle]])[k] / edge;
        stood_for = stood_for ||
                    (same && glm::dot(normal_of(mesh, one.triangle), normal_of(mesh, other.triangle)) > 0);
      }
      EXPECT_TRUE(stood_for) << "level " << level;
    }
  }
}

TEST(ExtraSamples, StandForFlatSidesNarrowerThanTwoSpacings) {
  // Its long sides are 1 mm wide: area over the diagonal is that, but for a part in a thousand.
  const auto of_sides = [](double spacing) {
    LatticeMesh mesh = build(solids::box(Vec3(0), Vec3(0.001, 0.02, 0.03), Int3(1)));
    const auto steps = static_cast<std::int32_t>(spacing / kStep);
    weigh_for_field(steps, find_tips(steps, mesh), mesh);
    return std::ranges::count_if(mesh.extra_samples, [&](const ExtraSample& extra) {
      return std::abs(normal_of(mesh, extra.triangle).x) < 0.5;
    });
  };
  EXPECT_EQ(of_sides(0.00049), 0);
  EXPECT_GT(of_sides(0.00052), 300);  // e is no more than a spacing: 100 mm² over its square
}

/// 1 where all triangles are flagged as thin, 0 where none is.
double thin_part(const LatticeMesh& mesh) {
  return static_cast<double>(std::ranges::count_if(
             mesh.flags, [](std::uint8_t flags) { return (flags & kTriangleThin) != 0; })) /
         static_cast<double>(mesh.flags.size());
}

TEST(ThinPieces, AreNarrowerThanNineSpacings) {
  // 4 V / A = 4 · 2 · 3 · 60 / (2 · (2 · 3 + 2 · 60 + 3 · 60)) mm.
  const double width = 1440.0 / 612 * 1e-3;
  const auto marked = [&](double of_width) {
    LatticeMesh mesh = build(solids::box(Vec3(0), Vec3(0.002, 0.003, 0.06), Int3(3)));
    mark_thin_pieces(static_cast<std::int32_t>(of_width * width / (9 * kStep)), {}, mesh);
    return thin_part(mesh);
  };
  EXPECT_EQ(marked(0.99), 0);  // corners are rounded to a micrometre
  EXPECT_EQ(marked(1.01), 1);
}

TEST(ThinPieces, AreClosedAndTellByThemselves) {
  const Mesh pin = solids::box(Vec3(0), Vec3(0.001, 0.001, 0.03), Int3(1)),
             block = solids::box(Vec3(0.1, 0, 0), Vec3(0.15, 0.05, 0.05), Int3(1));
  Mesh open = pin;
  open.triangles.pop_back();
  open.parts = {{"open", 0, static_cast<std::uint32_t>(open.triangles.size())}};
  LatticeMesh mesh = build(open);
  mark_thin_pieces(kSpacing, {}, mesh);
  EXPECT_EQ(thin_part(mesh), 0);
  Mesh both = pin;
  both.vertices.insert(both.vertices.end(), block.vertices.begin(), block.vertices.end());
  for (auto triangle : block.triangles) {
    for (auto& vertex : triangle) vertex += static_cast<std::uint32_t>(pin.vertices.size());
    both.triangles.push_back(triangle);
  }
  both.parts = {{"both", 0, static_cast<std::uint32_t>(both.triangles.size())}};
  mesh = build(both);
  mark_thin_pieces(kSpacing, {}, mesh);
  EXPECT_EQ(thin_part(mesh), 0.5);
  mark_thin_pieces(1, {}, mesh);
  EXPECT_EQ(thin_part(mesh), 0);
}

TEST(ThinPieces, AreNoHollows) {
  // As narrow as a pin, but a hole in a block: what lies about it has samples enough.
  Mesh hollow = solids::box(Vec3(-0.025), Vec3(0.025), Int3(1));
  const auto before = static_cast<std::uint32_t>(hollow.vertices.size());
  const Mesh pin = solids::box(Vec3(0), Vec3(0.001, 0.001, 0.02), Int3(1));
  hollow.vertices.insert(hollow.vertices.end(), pin.vertices.begin(), pin.vertices.end());
  for (const auto& [a, b, c] : pin.triangles)
    hollow.triangles.push_back({a + before, c + before, b + before});
  hollow.parts = {{"hollow", 0, static_cast<std::uint32_t>(hollow.triangles.size())}};
  LatticeMesh mesh = build(hollow);
  mark_thin_pieces(kSpacing, {}, mesh);
  EXPECT_EQ(thin_part(mesh), 0);
}

TEST(Gyration, OfABoxAboutItsMiddleAndAboutACorner) {
  // A cube's surface of side 2a about its middle: a² for the face's own axis, a²/3 for each of the others.
  const LatticeMesh cube = build(solids::box(Vec3(-0x1p-6), Vec3(0x1p-6), Int3(2, 3, 5)));
  const double a = 0x1p14;
  EXPECT_NEAR(gyration_radius(cube, Vec3(0)), a * std::sqrt(5.0 / 3), 1e-9 * a);
  EXPECT_NEAR(gyration_radius(cube, Vec3(a)), a * std::sqrt(5.0 / 3 + 3), 1e-9 * a);
  const auto geometry =
      build_geometry(solids::box(Vec3(0), Vec3(1)), solids::box(Vec3(0), Vec3(0.08, 0.02, 0.04)), {});
  ASSERT_TRUE(geometry);
  EXPECT_NEAR(geometry->reference_area_m2, 1e-4, 1e-7);  // (80 mm / 8)², the box in steps
  const double areas[3] = {0.02 * 0.04, 0.04 * 0.08, 0.08 * 0.02}, sides[3] = {0.08, 0.02, 0.04};
  double moment = 0, area = 0;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j) moment += areas[k] * sides[j] * sides[j] / (j == k ? 4 : 12);
  for (const double one : areas) area += one;
  EXPECT_NEAR(geometry->tool_gyration_m, std::sqrt(moment / area), 1e-5);
}

}  // namespace
}  // namespace palpate
