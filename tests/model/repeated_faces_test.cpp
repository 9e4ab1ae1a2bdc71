// Faces that are there twice push once: the field takes one of them, sets take all.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "model/generate/solids.h"
#include "model/mesh/patches.h"
#include "model/mesh/tips.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

constexpr double kStep = 0x1p-20;        // m, about a micrometre
constexpr std::int32_t kSpacing = 1468;  // 1.4 mm

LatticeMesh built_of(const Mesh& mesh) {
  MeshReport report;
  auto built = build_lattice_mesh(mesh, Lattice{kStep, Vec3(0)}, {}, report);
  EXPECT_TRUE(built) << built.error().sentence;
  weigh_for_field(kSpacing, find_tips(kSpacing, *built), *built);
  return std::move(*built);
}

std::vector<std::uint32_t> repeated_in(const LatticeMesh& mesh) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.repeated(t)) out.push_back(t);
  return out;
}

std::vector<std::uint32_t> numbers(std::uint32_t first, std::uint32_t end) {
  std::vector<std::uint32_t> out;
  for (std::uint32_t t = first; t < end; ++t) out.push_back(t);
  return out;
}

Mesh with_all_turned(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// A square of two triangles in the plane z = `height`, without an inside: two copies that look away from
/// each other are a part with winding 0 on both sides.
Mesh square_of_two_sides(double side, double height) {
  Mesh out;
  out.vertices = {Vec3(0, 0, height), Vec3(side, 0, height), Vec3(side, side, height), Vec3(0, side, height)};
  out.triangles = {{0, 1, 2}, {0, 2, 3}, {2, 1, 0}, {3, 2, 0}};
  out.parts = {{"square", 0, 4}};
  return out;
}

TEST(RepeatedFaces, OfABodyThatIsThereTwiceTheFirstPush) {
  // A cone has a tip, round and flat sides; a needle is seen by extra samples alone.
  for (const Mesh& once : {solids::cone(0.02, 0.04), solids::cone(0.001, 0.04, 12), solids::sphere(0.01)})
    for (const bool inside_out : {false, true}) {
      const LatticeMesh single = built_of(once);
      EXPECT_TRUE(repeated_in(single).empty());
      const auto count = static_cast<std::uint32_t>(once.triangles.size());
      Mesh twice;
      solids::append(twice, once, "first");
      solids::append(twice, inside_out ? with_all_turned(once) : once, "second");
      const LatticeMesh both = built_of(twice);
      EXPECT_EQ(repeated_in(both), numbers(count, 2 * count));
      ASSERT_EQ(both.field_weight_q30.size(), 2 * count);
      EXPECT_TRUE(std::equal(single.field_weight_q30.begin(), single.field_weight_q30.end(),
                             both.field_weight_q30.begin()));
      EXPECT_TRUE(std::all_of(both.field_weight_q30.begin() + count, both.field_weight_q30.end(),
                              [](std::uint32_t weight) { return weight == 0; }));
      EXPECT_EQ(single.extra_samples, both.extra_samples);
      EXPECT_EQ(single.side_levels, both.side_levels);
    }
}

TEST(RepeatedFaces, AreNoFacesOfBodiesSideBySide) {
  Mesh two;
  solids::append(two, solids::box(Vec3(0), Vec3(0.02)), "below");
  solids::append(two, solids::box(Vec3(0, 0, 0.02), Vec3(0.02, 0.02, 0.04)), "above");
  EXPECT_TRUE(repeated_in(built_of(two)).empty());
}

TEST(RepeatedFaces, OfASheetWithTwoSidesOnePushes) {
  const LatticeMesh sheet = built_of(square_of_two_sides(0.02, 0));
  ASSERT_NE(sheet.flags[0] & kTriangleSheet, 0);
  EXPECT_EQ(repeated_in(sheet), numbers(2, 4));
}

TEST(RepeatedFaces, OfASheetOnASolidFaceTheSolidPushes) {
  // The sheet comes first, and has the corners of the box's lid, whichever way that is cut.
  const Mesh box = solids::box(Vec3(0), Vec3(0.02));
  Mesh lid;
  lid.vertices = box.vertices;
  std::vector<std::uint32_t> on_lid;
  for (std::uint32_t t = 0; t < box.triangles.size(); ++t) {
    const auto& corners = box.triangles[t];
    if (std::any_of(corners.begin(), corners.end(),
                    [&](std::uint32_t v) { return box.vertices[v].z < 0.01; }))
      continue;
    on_lid.push_back(t);
    lid.triangles.push_back(corners);
    lid.triangles.push_back({corners[0], corners[2], corners[1]});
  }
  ASSERT_EQ(on_lid.size(), 2u);
  lid.parts = {{"", 0, 4}};
  Mesh both;
  solids::append(both, lid, "lid");
  solids::append(both, box, "box");
  EXPECT_EQ(repeated_in(built_of(both)), numbers(0, 4));
  // In one part likewise: of the three that lie there the first that looks out.
  both.parts = {{"both", 0, static_cast<std::uint32_t>(both.triangles.size())}};
  const LatticeMesh one = built_of(both);
  EXPECT_EQ(repeated_in(one).size(), 4u);
  for (const std::uint32_t t : {0u, 1u, 2u, 3u, 4 + on_lid[0], 4 + on_lid[1]}) {
    if (one.repeated(t)) continue;
    EXPECT_GT(one.unit_normal_q30[t].z, 0) << t;
  }
}

TEST(RepeatedFaces, OfABodyThatIsThereTwiceBesideAnotherAreThatBodysNot) {
  Mesh three;
  solids::append(three, solids::box(Vec3(0), Vec3(0.02)), "below");
  solids::append(three, solids::box(Vec3(0), Vec3(0.02)), "once more");
  solids::append(three, solids::box(Vec3(0, 0, 0.02), Vec3(0.02, 0.02, 0.04)), "above");
  EXPECT_EQ(repeated_in(built_of(three)), numbers(12, 24));
}

}  // namespace
}  // namespace palpate
