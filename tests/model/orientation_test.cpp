#include "model/mesh/orientation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/generate/solids.h"
#include "model/mesh/mass.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Built {
  LatticeMesh mesh;
  MeshReport report;
};

Built build(const Mesh& mesh) {
  Built out;
  auto built = build_lattice_mesh(mesh, choose_lattice(mesh, {}).value(), {}, out.report);
  EXPECT_TRUE(built) << built.error().sentence;
  out.mesh = std::move(*built);
  return out;
}

std::size_t count(const LatticeMesh& mesh, TriangleFlag flag) {
  return static_cast<std::size_t>(
      std::count_if(mesh.flags.begin(), mesh.flags.end(), [&](std::uint8_t f) { return f & flag; }));
}

Mesh shifted(const Mesh& mesh, const Vec3& by) { return solids::moved(mesh, {by, Quat(1, 0, 0, 0)}); }

TEST(Orientation, RightShellStaysAsGiven) {
  const Built built = build(solids::torus(0.3, 0.1));
  EXPECT_EQ(count(built.mesh, kTriangleTurned), 0u);
  EXPECT_TRUE(built.mesh.closed);
  EXPECT_TRUE(built.report.notes.empty());
  EXPECT_GT(measure(built.mesh).volume, 0);
}

TEST(Orientation, FlippedShellIsTurnedRoundAndReported) {
  for (const Mesh& mesh : {solids::box(Vec3(0), Vec3(1)), solids::sphere(1), solids::torus(0.3, 0.1)}) {
    const Built built = build(solids::turned_inside_out(mesh));
    EXPECT_EQ(count(built.mesh, kTriangleTurned), mesh.triangles.size());
    EXPECT_TRUE(built.report.parts[0].turned);
    EXPECT_GT(measure(built.mesh).volume, 0);
    EXPECT_THAT(built.report.notes, Contains(HasSubstr("inside out")));
  }
}

TEST(Orientation, SingleFlippedTrianglesAreMadeToAgree) {
  Mesh mesh = solids::sphere(1, 24, 12);
  std::size_t flipped = 0;
  for (std::size_t t = 1; t < mesh.triangles.size(); t += 7, ++flipped)
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const Built built = build(mesh);
  EXPECT_TRUE(built.mesh.closed);
  EXPECT_EQ(count(built.mesh, kTriangleTurned), flipped);
  EXPECT_FALSE(built.report.parts[0].turned);
  EXPECT_THAT(built.report.notes, Contains(HasSubstr("turned to agree")));
}

TEST(Orientation, TheFirstTriangleMayBeTheWrongOne) {
  Mesh mesh = solids::box(Vec3(0), Vec3(1));
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const Built built = build(mesh);
  EXPECT_EQ(count(built.mesh, kTriangleTurned), 1u)
      << "eleven turned to agree, then all twelve: the first is left";
  EXPECT_GT(measure(built.mesh).volume, 0);
}

TEST(Orientation, CavityKeepsItsInwardShell) {
  Mesh mesh;
  solids::append(mesh, solids::box(Vec3(0), Vec3(3)), "solid");
  solids::append(mesh, solids::turned_inside_out(solids::box(Vec3(1), Vec3(2))), "cavity");
  const Built built = build(mesh);
  EXPECT_EQ(count(built.mesh, kTriangleTurned), 0u);
  EXPECT_TRUE(built.mesh.closed);
}

TEST(Orientation, OverlappingClosedPartsAreBothRight) {
  Mesh mesh;
  solids::append(mesh, solids::sphere(1), "a");
  solids::append(mesh, shifted(solids::sphere(1), {0.9, 0.2, 0.1}), "b");
  const Built built = build(mesh);
  EXPECT_EQ(count(built.mesh, kTriangleTurned), 0u);
  EXPECT_EQ(count(built.mesh, kTriangleSheet), 0u);
  Mesh wrong;
  solids::append(wrong, solids::sphere(1), "a");
  solids::append(wrong, shifted(solids::turned_inside_out(solids::sphere(1)), {1.6, 0.2, 0.1}), "b");
  const Built turned = build(wrong);
  EXPECT_FALSE(turned.report.parts[0].turned);
  EXPECT_TRUE(turned.report.parts[1].turned);
}

TEST(Orientation, PartsThatShareAFaceKeepTheirSides) {
  // Two boxes back to back: four triangles on the shared face's edges, coincident faces skipped by the rays.
  Mesh mesh;
  solids::append(mesh, solids::box(Vec3(0), Vec3(1)), "a");
  solids::append(mesh, solids::turned_inside_out(solids::box(Vec3(1, 0, 0), Vec3(2, 1, 1))), "b");
  const Built built = build(mesh);
  EXPECT_FALSE(built.report.parts[0].turned);
  EXPECT_TRUE(built.report.parts[1].turned);
  EXPECT_TRUE(built.mesh.closed);
  EXPECT_GT(built.report.nonmanifold_edges, 0u);
}

TEST(Orientation, OpenSurfaceWithoutAnInsideIsASheet) {
  Mesh plate = solids::box(Vec3(0), Vec3(1, 1, 0.1), Int3(4, 4, 1));
  Mesh sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.2}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  sheet.parts = {{"", 0, 2}};
  const Built built = build(sheet);
  EXPECT_EQ(count(built.mesh, kTriangleSheet), 2u);
  EXPECT_TRUE(built.report.parts[0].sheet);
  EXPECT_EQ(built.report.open_edges, 4u);
  EXPECT_NEAR(built.report.largest_gap_m, std::sqrt(1 + 1 + 0.04), 1e-6);  // snapping: below 1 µm
  EXPECT_EQ(count(build(plate).mesh, kTriangleSheet), 0u);
}

TEST(Orientation, BoxMissingAFaceIsStillASolid) {
  Mesh box = solids::box(Vec3(0), Vec3(1));
  box.triangles.resize(10);
  box.parts[0].triangle_count = 10;
  for (const bool inside_out : {false, true}) {
    const Built built = build(inside_out ? solids::turned_inside_out(box) : box);
    EXPECT_EQ(count(built.mesh, kTriangleSheet), 0u);
    EXPECT_EQ(built.report.parts[0].turned, inside_out);
    EXPECT_FALSE(built.mesh.closed);
    EXPECT_EQ(built.report.open_edges, 4u);
    EXPECT_NEAR(built.report.largest_gap_m, std::sqrt(2.0), 1e-6);
  }
}

TEST(Orientation, MoebiusBandIsReportedAndLeftAsGiven) {
  Mesh band;
  constexpr std::uint32_t kSegments = 32;
  for (std::uint32_t i = 0; i < kSegments; ++i) {
    const double along = 2 * M_PI * i / kSegments, twist = along / 2;
    const Vec3 out(std::cos(along), std::sin(along), 0);
    for (const double side : {-0.2, 0.2})
      band.vertices.push_back(out + side * (std::cos(twist) * out + std::sin(twist) * Vec3(0, 0, 1)));
  }
  for (std::uint32_t i = 0; i < kSegments; ++i) {
    std::uint32_t a = 2 * i, b = a + 1, c = (a + 2) % (2 * kSegments), d = c + 1;
    if (i + 1 == kSegments) std::swap(c, d);  // half a turn makes the ends meet the other way round
    band.triangles.push_back({a, c, b});
    band.triangles.push_back({b, c, d});
  }
  band.parts = {{"band", 0, 2 * kSegments}};
  const Built built = build(band);
  EXPECT_FALSE(built.report.parts[0].orientable);
  EXPECT_EQ(count(built.mesh, kTriangleTurned), 0u);
  EXPECT_THAT(built.report.notes, Contains(HasSubstr("one-sided")));
}

TEST(Orientation, ATiltedSoupOfClosedShellsIsRightInEveryPose) {
  // Rays run along axes through exact centroids: tilted, touching and nested shells must give the same
  // verdict.
  for (int pose = 0; pose < 8; ++pose) {
    Mesh mesh;
    const Quat turn = glm::normalize(Quat(1, 0.3 * pose, 0.2, -0.1 * pose));
    for (int i = 0; i < 6; ++i) {
      const Mesh part =
          solids::moved(solids::cylinder(0.1, 0.3, 12), {Vec3(0.15 * i, 0.02 * i, 0.05 * i), turn});
      solids::append(mesh, i % 2 ? solids::turned_inside_out(part) : part, std::to_string(i));
    }
    const Built built = build(mesh);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_EQ(built.report.parts[i].turned, i % 2 == 1) << "pose " << pose << ", part " << i;
    EXPECT_TRUE(built.mesh.closed);
  }
}

TEST(Orientation, ATriangleCollapsedToALineKeepsTheMeshClosed) {
  // The box's edge 0–1 gets a T-junction that a triangle of no area bridges: half the STL files of CAD
  // systems have these.
  Mesh mesh = solids::box(Vec3(0), Vec3(1));
  const auto [a, b, c] = mesh.triangles[0];
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
  mesh.triangles[0] = {a, middle, c};
  mesh.triangles.push_back({middle, b, c});
  mesh.triangles.push_back({a, b, middle});
  mesh.parts[0].triangle_count += 2;
  const Built built = build(solids::turned_inside_out(mesh));
  EXPECT_EQ(built.report.collapsed, 1u);
  EXPECT_TRUE(built.mesh.closed);
  EXPECT_TRUE(built.report.parts[0].turned);
  EXPECT_NEAR(measure(built.mesh).volume / std::pow(2.0 * built.mesh.box_max.x, 3), 1.0,
              1e-12);  // sums of 14 doubles
  for (const EdgeNeighbour n : built.mesh.neighbours) EXPECT_FALSE(built.mesh.collapsed(n / 2));
}

TEST(Orientation, ATJunctionThatClosesPointForPointIsClosed) {
  for (const double off : {0.0, 1e-3}) {  // the vertex in the middle of the edge, and a millimetre beside it
    Mesh mesh = solids::box(Vec3(0), Vec3(1));
    const auto [a, b, c] = mesh.triangles[0];
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]) +
                            off * (mesh.vertices[c] - mesh.vertices[a]));
    mesh.triangles[0] = {a, middle, c};
    mesh.triangles.push_back({middle, b, c});
    mesh.parts[0].triangle_count += 1;
    const Built built = build(mesh);
    EXPECT_EQ(built.mesh.closed, off == 0);
    EXPECT_EQ(built.report.parts[0].closed, off == 0);
    EXPECT_EQ(built.report.largest_gap_m > 0, off > 0);
    EXPECT_EQ(built.report.open_edges, 3u);
    EXPECT_EQ(count(built.mesh, kTriangleTurned), 0u);
    if (off == 0) {
      EXPECT_THAT(
          built.report.notes,
          Contains(HasSubstr(
              "3 edges carry one triangle and are met by shorter ones of their neighbours (T-junctions)")));
    }
  }
}

TEST(Orientation, WindingsInOverlappingSolidsCountTheSolids) {
  // First a box in cells of three and a larger one in cells of one: the former's centroids are over the
  // latter's corners, so only a consistent tie rule counts each crossing once. Then overlapping boxes and a
  // ring in general position. No two faces coincide.
  Mesh tied, general;
  solids::append(tied, solids::box(Vec3(0), Vec3(9), Int3(3)), "cells of three");
  solids::append(tied, solids::box(Vec3(-3, -3, -3.5), Vec3(12, 12, 3.5), Int3(15, 15, 7)), "cells of one");
  for (int i = 0; i < 4; ++i) {
    const double d = i * 0.125 + 0.001 * i * i;
    solids::append(general,
                   solids::box(Vec3(d, 0.25 * i + d, d), Vec3(3 + d, 3 + 2 * d, 3 - d), Int3(3, 4, 6)),
                   std::to_string(i));
  }
  solids::append(general,
                 solids::moved(solids::torus(0.8, 0.3, 16, 8), {Vec3(1.5), glm::normalize(Quat(1, 1, 0, 0))}),
                 "ring");
  for (const Mesh& mesh : {tied, general}) {
    const Built built = build(mesh);
    ASSERT_TRUE(built.mesh.closed);
    std::vector<std::uint32_t> all(built.mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    int deepest = 0;
    for (const SideWinding& w : side_windings(built.mesh, all)) {
      EXPECT_EQ(w.back_side - w.normal_side, 1);
      EXPECT_GE(w.normal_side, 0);
      deepest = std::max(deepest, w.back_side);
    }
    EXPECT_EQ(deepest, static_cast<int>(mesh.parts.size()));
  }
}

TEST(Orientation, ACentroidOnAnotherPlaneIsMovedAlongItsTriangleFirst) {
  // A triangle at z = 0 with its centroid in the origin, and a wedge whose top passes through the origin,
  // along z = x or z = −x. (u, v) = (x, y), so the centroid moves by +ε along x: it dives below the first top
  // and rises above the second.
  for (const double slope : {1.0, -1.0}) {
    Mesh wedge = solids::box(Vec3(-4, -4, -8), Vec3(4, 4, 0));
    for (Vec3& v : wedge.vertices)
      if (v.z == 0) v.z = slope * v.x;
    Mesh mesh;
    mesh.vertices = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.parts = {{"sheet", 0, 1}};
    solids::append(mesh, wedge, "wedge");
    const Built built = build(mesh);
    const SideWinding w = side_windings(built.mesh, {0})[0];
    EXPECT_EQ(w.normal_side, slope > 0 ? 1 : 0);
    EXPECT_EQ(w.back_side, slope > 0 ? 1 : 0);
  }
}

TEST(Neighbours, AreSymmetricAscendingAndCarryTheSmoothBit) {
  const Built built = build(solids::cylinder(1, 2, 48));
  const LatticeMesh& m = built.mesh;
  std::size_t smooth_edges = 0;
  for (std::uint32_t t = 0; t < m.triangles.size(); ++t) {
    EXPECT_EQ(m.neighbour_begin[t + 1] - m.neighbour_begin[t], 3u);
    for (std::uint32_t i = m.neighbour_begin[t]; i < m.neighbour_begin[t + 1]; ++i) {
      EXPECT_TRUE(i == m.neighbour_begin[t] || m.neighbours[i - 1] < m.neighbours[i]);
      const std::uint32_t other = m.neighbours[i] / 2, back = t * 2 + (m.neighbours[i] & 1);
      EXPECT_TRUE(std::binary_search(m.neighbours.begin() + m.neighbour_begin[other],
                                     m.neighbours.begin() + m.neighbour_begin[other + 1], back));
      smooth_edges += m.neighbours[i] & 1;
    }
  }
  // Sharp: the two rims of 48 edges each, seen from both sides.
  EXPECT_EQ(smooth_edges, m.neighbours.size() - 2 * 2 * 48);
}

TEST(Neighbours, AllTrianglesOnANonManifoldEdgeAreNeighbours) {
  Mesh fins;
  fins.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0.1, 0}, {0, 1, 0}, {1, 0, 0}};
  fins.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 5}};  // the last repeats the first
  fins.parts = {{"fins", 0, 4}};
  const Built built = build(fins);
  for (std::uint32_t t = 0; t < 4; ++t)
    EXPECT_EQ(built.mesh.neighbour_begin[t + 1] - built.mesh.neighbour_begin[t], 3u);
  EXPECT_EQ(built.report.duplicate, 1u);
  EXPECT_EQ(built.report.nonmanifold_edges, 1u);
}

TEST(Neighbours, AnEdgeWithTooManyTrianglesIsRefused) {
  Mesh fan;
  fan.vertices = {{0, 0, 0}, {0, 0, 1}};
  for (std::uint32_t i = 0; i < 5000; ++i) {
    fan.vertices.push_back({std::cos(i * 1e-3), std::sin(i * 1e-3), 0});
    fan.triangles.push_back({0, 1, i + 2});
  }
  MeshReport report;
  const auto built = build_lattice_mesh(fan, choose_lattice(fan, {}).value(), {}, report);
  ASSERT_FALSE(built);
  EXPECT_THAT(built.error().sentence, HasSubstr("carries 5000 triangles, the limit is 4096"));
}

}  // namespace
}  // namespace palpate
