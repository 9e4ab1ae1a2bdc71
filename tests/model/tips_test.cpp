// Pointed corners have samples of their own: what they say of a tip pressed into a plane is its volume, and
// pushes it nowhere but out.
#include "model/mesh/tips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "model/generate/solids.h"
#include "model/lattice/triangle.h"
#include "model/mesh/patches.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

constexpr double kStep = 0x1p-20;         // m, about a micrometre
constexpr std::int32_t kSpacing = 0x200;  // about half a millimetre
constexpr double kAskew = 1e-3;           // 0.06°, a fiftieth of what the judge of forces allows

LatticeMesh build(const Mesh& mesh) {
  MeshReport report;
  auto built = build_lattice_mesh(mesh, Lattice{kStep, Vec3(0)}, {}, report);
  EXPECT_TRUE(built) << built.error().sentence;
  return std::move(*built);
}

std::size_t tips_of(const Mesh& mesh) { return find_tips(kSpacing, build(mesh)).size(); }

TEST(Tips, AreConesAndNeedlesButNoEdgesBlocksOrBalls) {
  EXPECT_EQ(tips_of(solids::cone(0.005, 0.01, 48)), 1u);
  EXPECT_EQ(tips_of(solids::cone(0.001, 0.01, 3)), 1u);
  EXPECT_EQ(tips_of(solids::cone(0.0057, 0.01, 96)), 1u);  // 29.7° from its axis
  EXPECT_EQ(tips_of(solids::cone(0.0058, 0.01, 96)), 0u);  // 30.1°
  EXPECT_EQ(tips_of(solids::box(Vec3(0), Vec3(0.02, 0.02, 0.0002))), 0u);
  EXPECT_EQ(tips_of(solids::cylinder(0.0005, 0.02, 12)), 0u);
  EXPECT_EQ(tips_of(solids::sphere(0.01)), 0u);
  Mesh wedge = solids::box(Vec3(0), Vec3(0.02));  // knife-edged: two of its edges meet
  for (Vec3& v : wedge.vertices)
    if (v.z < 0.01) v.x = 0.01;
  EXPECT_EQ(tips_of(wedge), 0u);
}

TEST(Tips, AreNoPitsAndNoOpenOnes) {
  Mesh pit = solids::turned_inside_out(solids::cone(0.005, 0.01, 48));
  const LatticeMesh hollow = [&] {
    // A block about it, so that it isn't taken for a body that is inside out.
    Mesh both = solids::box(Vec3(-0.02, -0.02, -0.01), Vec3(0.02, 0.02, 0.02));
    const auto before = static_cast<std::uint32_t>(both.vertices.size());
    both.vertices.insert(both.vertices.end(), pit.vertices.begin(), pit.vertices.end());
    for (const auto& [a, b, c] : pit.triangles)
      both.triangles.push_back({a + before, b + before, c + before});
    both.parts = {{"both", 0, static_cast<std::uint32_t>(both.triangles.size())}};
    return build(both);
  }();
  EXPECT_TRUE(find_tips(kSpacing, hollow).empty());
  Mesh open = solids::cone(0.005, 0.01, 48);
  open.triangles.erase(open.triangles.begin());
  open.parts = {{"open", 0, static_cast<std::uint32_t>(open.triangles.size())}};
  EXPECT_EQ(tips_of(open), 0u);
}

TEST(Tips, AreFoundWhicheverCornersOfTheirTrianglesTheyAre) {
  Mesh mesh = solids::cone(0.005, 0.01, 48);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    std::rotate(mesh.triangles[i].begin(), mesh.triangles[i].begin() + static_cast<std::ptrdiff_t>(i % 3),
                mesh.triangles[i].end());
  EXPECT_EQ(tips_of(mesh), 1u);
}

TEST(Tips, CloseOnceAndHaveNoCollapsedTriangle) {
  // Two needles that begin at one corner.
  Mesh two = solids::cone(0.001, 0.01, 12);
  const Mesh other = solids::moved(two, {Vec3(0), Quat(0.9, 0.43588989435406736, 0, 0)});
  const auto before = static_cast<std::uint32_t>(two.vertices.size());
  two.vertices.insert(two.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + before, b + before, c + before});
  two.parts = {{"two", 0, static_cast<std::uint32_t>(two.triangles.size())}};
  EXPECT_EQ(tips_of(two), 0u);
  // A fan whose walk from the first triangle runs into others that close without it.
  Mesh fan = solids::cone(0.001, 0.01, 12);
  fan.vertices.emplace_back(0.0011, -0.0003, 0.01);
  fan.triangles.insert(fan.triangles.begin(), {0, static_cast<std::uint32_t>(fan.vertices.size() - 1), 2});
  fan.parts = {{"fan", 0, static_cast<std::uint32_t>(fan.triangles.size())}};
  EXPECT_EQ(tips_of(fan), 0u);
  // One of its sides is cut in two where it meets the next one, and between them lies what has no area.
  Mesh cut = solids::cone(0x1p-8, 0x1p-7, 4);  // whole steps
  ASSERT_EQ(tips_of(cut), 1u);
  cut.vertices.push_back(0.5 * cut.vertices[2]);
  ASSERT_EQ(cut.triangles[6], (std::array<std::uint32_t, 3>{0, 2, 5}));
  cut.triangles[6] = {0, 6, 5};
  cut.triangles.push_back({6, 2, 5});
  cut.triangles.push_back({0, 2, 6});
  cut.parts = {{"cut", 0, static_cast<std::uint32_t>(cut.triangles.size())}};
  EXPECT_EQ(tips_of(cut), 0u);
}

TEST(Tips, HaveTheirTrianglesInOrderAndNoneOfAnother) {
  // A tetrahedron so long that both of its ends are pointed; two of its triangles are of both.
  Mesh both;
  both.vertices = {Vec3(-0.01, 0, 0.0003), Vec3(0.01, 0, 0.0003), Vec3(0, 0.001, 0), Vec3(0, 0, 0.002)};
  both.triangles = {{0, 2, 1}, {1, 2, 3}, {0, 3, 2}, {0, 1, 3}};
  both.parts = {{"both", 0, 4}};
  const auto tips = find_tips(kSpacing, build(both));
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_EQ(tips.front().triangles.size(), 3u);
  const LatticeMesh round = build(solids::cone(0.005, 0.01, 48));
  const Tip tip = find_tips(kSpacing, round).front();
  ASSERT_EQ(tip.triangles.size(), 48u);
  for (std::size_t i = 0; i < 48; ++i) {
    const auto &one = round.triangles[tip.triangles[i]], &next = round.triangles[tip.triangles[(i + 1) % 48]];
    int shared = 0;
    for (const std::uint32_t v : one) shared += v == next[0] || v == next[1] || v == next[2] ? 1 : 0;
    EXPECT_EQ(shared, 2) << i;
  }
}

TEST(Tips, OfManySpacingsHaveTheGridsSamples) {
  const LatticeMesh mesh = build(solids::cone(0.05, 0.1, 96));
  EXPECT_EQ(find_tips(kSpacing, mesh).size(), 1u);      // 66,000 s²
  EXPECT_EQ(find_tips(kSpacing / 4, mesh).size(), 0u);  // 1,056,000
}

struct TipShape {
  double radius, height;
  std::uint32_t sides;
};
class TipSamples : public testing::TestWithParam<TipShape> {};

TEST_P(TipSamples, SayTheirAreaTheWaysItFacesAndHowMuchOfItIsInAPlane) {
  const auto [radius, height, sides] = GetParam();
  LatticeMesh mesh = build(solids::cone(radius, height, sides));
  const auto tips = find_tips(kSpacing, mesh);
  ASSERT_EQ(tips.size(), 1u);
  weigh_for_field(kSpacing, tips, mesh);
  mark_thin_pieces(kSpacing / 64, tips, mesh);  // so that no piece is thin by itself
  double area = 0, is_area = 0;
  Vec3 normal(0), is_normal(0);
  for (const std::uint32_t t : tips.front().triangles) {
    const Vec3 raw(raw_normal(mesh, t));
    is_area += glm::length(raw) / 2;
    is_normal += 0.5 * raw;
    EXPECT_EQ(mesh.field_weight_q30[t], 0u);
    EXPECT_NE(mesh.flags[t] & kTriangleThin, 0);
  }
  const auto of_tip = [&](const ExtraSample& extra) {
    return mesh.unit_normal_q30[extra.triangle].z < 0;  // the cap looks up
  };
  const double square = double{kSpacing} * kSpacing * 0x1p-30;
  for (const ExtraSample& extra : mesh.extra_samples) {
    if (!of_tip(extra)) continue;
    area += square * extra.weight_q30;
    normal += square * 0x1p-30 * extra.weight_q30 * Vec3(mesh.unit_normal_q30[extra.triangle]);
  }
  EXPECT_NEAR(area / is_area, 1, 1e-9) << "weights are rounded to 2^-30 s²";
  EXPECT_LE(glm::length(normal - is_normal) / is_area, kAskew);
  // Pressed down by h into a plane: Σ w (h − z) (−n) is the volume below it, upwards.
  const double top = height / kStep, base = sides / 2.0 * std::sin(2 * std::numbers::pi / sides) * radius *
                                            radius / (kStep * kStep);
  for (double h = kSpacing / 2.0; h < 0.9 * top; h *= 1.37) {
    Vec3 push(0);
    for (const ExtraSample& extra : mesh.extra_samples)
      if (of_tip(extra) && extra.point.z < h)
        push -= square * 0x1p-30 * extra.weight_q30 * (h - extra.point.z) *
                Vec3(mesh.unit_normal_q30[extra.triangle]);
    const double volume = base * (h / top) * (h / top) * h / 3;
    // The last ring is a fifth of h wide: cut anywhere, it says 3 % of the volume wrongly at most, the others
    // a twelfth of 1/25 of theirs.
    EXPECT_NEAR(push.z / volume, 1, 0.04) << h / kSpacing;
    EXPECT_LE(std::hypot(push.x, push.y) / volume, kAskew) << h / kSpacing;
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, TipSamples,
                         testing::Values(TipShape{0.005, 0.01, 96}, TipShape{0.005, 0.01, 7},
                                         TipShape{0.002, 0.01, 24}, TipShape{0.001, 0.01, 4},
                                         TipShape{0.0005, 0.01, 3}));

}  // namespace
}  // namespace palpate
