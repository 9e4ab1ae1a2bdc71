#include "model/generate/solids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "model/generate/turn.h"

namespace palpate {
namespace {

struct SolidCase {
  const char* name;
  std::function<Mesh()> make;
  std::size_t triangles;
  double volume;     ///< m³, of the smooth solid
  double tolerance;  ///< relative: what an inscribed polygon of that many sides lacks (derived: about 6.6 /
                     ///< n² and twice that)
};

class Solids : public testing::TestWithParam<SolidCase> {};

TEST_P(Solids, AreClosedOrientedOutwardAndOfTheVolumeAndCountPromised) {
  const Mesh mesh = GetParam().make();
  EXPECT_EQ(mesh.triangles.size(), GetParam().triangles);
  EXPECT_EQ(solids::open_edges(mesh), 0u);
  EXPECT_NEAR(solids::volume(mesh), GetParam().volume, GetParam().tolerance * GetParam().volume);
  ASSERT_EQ(mesh.parts.size(), 1u);
  EXPECT_EQ(mesh.parts[0].triangle_count, mesh.triangles.size());
}

INSTANTIATE_TEST_SUITE_P(
    All, Solids,
    testing::Values(SolidCase{"box",
                              [] {
                                return solids::box({-1, -2, -3}, {1, 2, 3});
                              },
                              12, 48, 1e-12},
                    SolidCase{"cells",
                              [] {
                                return solids::box({0, 0, 0}, {0.1, 0.2, 0.3}, {2, 3, 5});
                              },
                              4 * (6 + 15 + 10), 0.006, 1e-12},
                    SolidCase{"sphere", [] { return solids::sphere(0.02, 48, 24); }, 2 * 48 * 23,
                              4.0 / 3 * kPi * 8e-6, 0.02},
                    SolidCase{"cone", [] { return solids::cone(0.5, 2, 64); }, 2 * 64,
                              0.25 * 2 / 3 * 32 * std::sin(std::numbers::pi / 32), 1e-12},
                    SolidCase{"cylinder", [] { return solids::cylinder(0.5, 2, 64, 3, 2); }, 2 * 64 * 6,
                              kPi * 0.25 * 2, 0.002},
                    SolidCase{"ring", [] { return solids::ring(0.5, 1, 0.1, 64); }, 8 * 64, kPi * 0.75 * 0.1,
                              0.002},
                    SolidCase{"torus", [] { return solids::torus(1, 0.25, 64, 32); }, 2 * 64 * 32,
                              2 * kPi* kPi * 0.0625, 0.01}),
    [](const auto& test_case) { return std::string(test_case.param.name); });

TEST(SolidsHelpers, ATriangleLeftOutIsSeenAsThreeOpenEdges) {
  Mesh mesh = solids::box(Vec3(0), Vec3(1), {4, 4, 4});
  mesh.triangles.pop_back();
  EXPECT_EQ(solids::open_edges(mesh), 3u);
}

TEST(SolidsHelpers, TurnedInsideOutHasTheNegativeVolume) {
  EXPECT_NEAR(solids::volume(solids::turned_inside_out(solids::box(Vec3(0), Vec3(1)))), -1, 1e-12);
}

TEST(SolidsHelpers, SphereOfMeetsTheCountWithinFourPercent) {
  for (const double n : {1e3, 1e4, 1e5})
    EXPECT_NEAR(static_cast<double>(solids::sphere_of(1, static_cast<std::uint64_t>(n)).triangles.size()), n,
                0.04 * n);
}

TEST(Turn, AgreesWithTheLibraryAndIsExactAtQuarters) {
  for (int i = -1000; i <= 1000; ++i) {
    const Turn t = turn_by(i / 137.0);
    EXPECT_NEAR(t.cos, std::cos(2 * kPi * (i / 137.0)), 2e-14);  // the library's argument is rounded at 2π·7
    EXPECT_NEAR(t.sin, std::sin(2 * kPi * (i / 137.0)), 2e-14);
  }
  EXPECT_EQ(turn_by(0.25).cos, 0);
  EXPECT_EQ(turn_by(0.25).sin, 1);
  EXPECT_EQ(turn_by(-0.5).cos, -1);
}

}  // namespace
}  // namespace palpate
