#include "model/lattice/pose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

SceneGeometry scene(const Vec3& tool_at = Vec3(0)) {
  const Mesh tool = solids::moved(solids::sphere(0.05, 16, 8), {tool_at, Quat(1, 0, 0, 0)});
  return build_geometry(solids::box(Vec3(-0.5), Vec3(0.5)), tool, {}).value();
}

Quat random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(Quat(normal(random), normal(random), normal(random), normal(random)));
}

TEST(PoseRounding, IdentityIsExact) {
  const SceneGeometry geometry = scene({0.3, -0.2, 7});
  const LatticePose pose = to_lattice({}, geometry).value();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_EQ(pose.rotation_q30[r][c], r == c ? 1 << 30 : 0);
}

TEST(PoseRounding, QuaternionAndItsNegativeAreTheSamePose) {
  std::mt19937 random(7);
  const SceneGeometry geometry = scene();
  for (int i = 0; i < 100; ++i) {
    const Quat q = random_rotation(random);
    const LatticePose a = to_lattice({Vec3(0.1), q}, geometry).value(),
                      b = to_lattice({Vec3(0.1), -q}, geometry).value();
    EXPECT_TRUE(std::equal(&a.rotation_q30[0][0], &a.rotation_q30[0][0] + 9, &b.rotation_q30[0][0]));
    EXPECT_EQ(a.translation, b.translation);
  }
}

TEST(PoseRounding, EntriesStayWithinOneAndVerticesWithinTwoSteps) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.5, 0.5);
  const SceneGeometry geometry = scene({0.3, -0.2, 7});
  const double h = geometry.lattice.step_m;
  for (int i = 0; i < 500; ++i) {
    const Quat q = random_rotation(random);
    const Vec3 position = Vec3(place(random), place(random), place(random)) - q * geometry.tool_centre_m;
    const LatticePose pose = to_lattice({position, q}, geometry).value();
    ASSERT_FALSE(pose.beyond_lattice);
    for (const auto& row : pose.rotation_q30)
      for (const std::int32_t entry : row) EXPECT_LE(std::abs(entry), 1 << 30);
    for (const Int3& v : geometry.tool.vertices) {
      const Vec3 there = geometry.lattice.origin_m + h * Vec3(transform(pose, v));
      const Vec3 truth = position + q * (geometry.tool_centre_m + h * Vec3(v));
      // Half a step from the translation, half from the shift, 0.22 from the matrix, a component; doubles at
      // 7 m: 1e-15 m.
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], truth[k], 1.25 * h);
    }
  }
}

TEST(PoseRounding, HalfTurnsAreExact) {
  const SceneGeometry geometry = scene();
  const LatticePose pose = to_lattice({Vec3(0), Quat(0, 0, 0, 1)}, geometry).value();
  EXPECT_EQ(pose.rotation_q30[0][0], -(1 << 30));
  EXPECT_EQ(pose.rotation_q30[1][1], -(1 << 30));
  EXPECT_EQ(pose.rotation_q30[2][2], 1 << 30);
}

TEST(PoseRounding, SlightlyLongQuaternionsAreNormalised) {
  const SceneGeometry geometry = scene();
  const LatticePose pose = to_lattice({Vec3(0), Quat(1.0004, 0, 0, 0)}, geometry).value();
  EXPECT_EQ(pose.rotation_q30[0][0], 1 << 30);
}

TEST(Pose, NotFiniteOrNotUnitIsOneSentence) {
  const SceneGeometry geometry = scene();
  const double nan = std::nan("");
  for (const Pose& bad : {Pose{{nan, 0, 0}, Quat(1, 0, 0, 0)}, Pose{{0, HUGE_VAL, 0}, Quat(1, 0, 0, 0)},
                          Pose{Vec3(0), Quat(nan, 0, 0, 0)}, Pose{Vec3(0), Quat(0, 0, 0, 0)},
                          Pose{Vec3(0), Quat(1, 0.1, 0, 0)}, Pose{Vec3(0), Quat(1e200, 0, 0, 0)}}) {
    const auto result = to_lattice(bad, geometry);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kBadValue);
    EXPECT_THAT(result.error().sentence, testing::HasSubstr("the pose's"));
  }
}

TEST(Pose, BeyondTheLatticeIsFreeNotAnError) {
  const SceneGeometry geometry = scene();
  for (const double far : {2.0, 1e6, 1e300, -1e300}) {
    const auto pose = to_lattice({{0, far, 0}, Quat(1, 0, 0, 0)}, geometry);
    ASSERT_TRUE(pose);
    EXPECT_TRUE(pose->beyond_lattice);
  }
}

TEST(Pose, IsFreeFromWhereTheToolsSphereMissesTheGrid) {
  const SceneGeometry geometry = scene();
  const VoxelGrid& grid = geometry.mockup_grid;
  const Int3 top = grid.origin + grid.size * grid.voxels();
  for (const int steps : {-1, 0, 1, 2}) {
    const Vec3 at = geometry.lattice.origin_m +
                    geometry.lattice.step_m * Vec3(0, 0, top.z + geometry.tool_radius + steps);
    EXPECT_EQ(to_lattice({at, Quat(1, 0, 0, 0)}, geometry)->beyond_lattice, steps > 0) << steps;
  }
  // Off a corner the sphere counts, not its box.
  const Vec3 corner =
      geometry.lattice.origin_m + geometry.lattice.step_m * (Vec3(top) + 0.7 * geometry.tool_radius);
  EXPECT_TRUE(to_lattice({corner, Quat(1, 0, 0, 0)}, geometry)->beyond_lattice);
}

TEST(Pose, WithinTheLatticeEveryVertexIsWithinReach) {
  std::mt19937 random(5);
  const SceneGeometry geometry = scene();
  std::uniform_real_distribution<double> place(-1.2, 1.2);
  int within = 0, beyond = 0;
  for (int i = 0; i < 2000; ++i) {
    const LatticePose pose =
        to_lattice({{place(random), place(random), place(random)}, random_rotation(random)}, geometry)
            .value();
    if (pose.beyond_lattice) {
      ++beyond;
      continue;
    }
    ++within;
    for (const Int3& v : geometry.tool.vertices) {
      const Int3 p = transform(pose, v);
      ASSERT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), kLatticeReach);
    }
  }
  EXPECT_GT(within, 100);
  EXPECT_GT(beyond, 100);
}

}  // namespace
}  // namespace palpate
