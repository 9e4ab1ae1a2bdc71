#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/generate/solids.h"
#include "model/lattice/voxel_size.h"
#include "model/mesh/weld.h"
#include "model/scene/geometry_build.h"

namespace palpate {
namespace {

using testing::HasSubstr;

Mesh triangle(const Vec3& a, const Vec3& b, const Vec3& c) { return {{a, b, c}, {{0, 1, 2}}, {{"t", 0, 1}}}; }

std::int64_t reach_of(const VoxelGrid& grid) {
  std::int64_t reach = 0;
  for (int k = 0; k < 3; ++k)
    reach = std::max({reach, -std::int64_t{grid.origin[k]},
                      grid.origin[k] + std::int64_t{grid.size} * 8 * grid.bricks[k]});
  return reach;
}

TEST(Lattice, StepIsThePowerOfTwoThatJustFits) {
  for (const double size : {1e-4, 0.1, 3.0, 40.0, 26000.0}) {
    const Mesh mockup = solids::box(Vec3(-size / 2), Vec3(size / 2)),
               tool = solids::box(Vec3(0), Vec3(size / 10));
    const auto built = build_geometry(mockup, tool, {});
    ASSERT_TRUE(built) << built.error().sentence;
    int exponent = 0;
    EXPECT_EQ(std::frexp(built->lattice.step_m, &exponent), 0.5);
    const std::int64_t reach = reach_of(built->mockup_grid) + 2 * std::int64_t{built->tool_radius};
    EXPECT_LE(reach, kLatticeReach);
    EXPECT_GT(4 * reach, kLatticeReach) << "a finer step would have done";
  }
}

TEST(Lattice, OriginIsAWholeNumberOfStepsNearTheMockupsCentre) {
  const Vec3 far(12.3456789, -7.7, 1000.1);
  const auto built = build_geometry(solids::box(far - Vec3(0.5), far + Vec3(0.5)), solids::sphere(0.05), {});
  ASSERT_TRUE(built);
  for (int k = 0; k < 3; ++k) {
    const double steps = built->lattice.origin_m[k] / built->lattice.step_m;
    EXPECT_EQ(steps, std::nearbyint(steps));
    EXPECT_NEAR(built->lattice.origin_m[k], far[k], built->lattice.step_m);
  }
}

TEST(Lattice, ToolEqualToTheMockupSnapsToTheSamePoints) {
  const Mesh mesh = solids::sphere(0.7, 20, 12);
  const auto built = build_geometry(mesh, mesh, {});
  ASSERT_TRUE(built);
  EXPECT_EQ(built->tool_centre_m, built->lattice.origin_m);
  EXPECT_EQ(built->tool.vertices, built->mockup.vertices);
}

TEST(Lattice, PointsSnapToTheNearest) {
  const Mesh mesh = solids::sphere(0.7, 20, 12);
  const Lattice lattice{0x1p-10, Vec3(0)};  // a coarse one, about a millimetre
  MeshReport report;
  const auto built = build_lattice_mesh(mesh, lattice, {}, report);
  ASSERT_TRUE(built);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3 off = lattice.step_m * Vec3(built->corner(t, k)) -
                       mesh.vertices[mesh.triangles[t][static_cast<std::size_t>(k)]];
      for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(off[axis]), 0.5 * lattice.step_m);
    }
}

TEST(Weld, EqualLatticePointsBecomeOneVertex) {
  // A soup of 12 triangles with 36 corners is a box of 8.
  Mesh soup;
  const Mesh box = solids::box(Vec3(0), Vec3(1));
  for (const auto& t : box.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) soup.vertices.push_back(box.vertices[v] + Vec3(first * 1e-12));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  MeshReport report;
  const auto built = build_lattice_mesh(soup, choose_lattice(soup, {}).value(), {}, report);
  ASSERT_TRUE(built);
  EXPECT_EQ(built->vertices.size(), 8u);
  EXPECT_TRUE(built->closed);
  EXPECT_EQ(built->neighbours.size(), 36u);
}

TEST(Weld, CollapsedTrianglesKeepTheirNumber) {
  Mesh mesh = solids::box(Vec3(0), Vec3(1));
  mesh.triangles.insert(mesh.triangles.begin() + 3, {0, 1, 1});
  mesh.vertices.push_back(mesh.vertices[0] * 0.5 + mesh.vertices[1] * 0.5);
  mesh.triangles.push_back(
      {0, 1, static_cast<std::uint32_t>(mesh.vertices.size() - 1)});  // three points on a line
  MeshReport report;
  const auto built = build_lattice_mesh(mesh, choose_lattice(mesh, {}).value(), {}, report);
  ASSERT_TRUE(built);
  EXPECT_EQ(built->triangles.size(), 14u);
  EXPECT_EQ(report.collapsed, 2u);
  EXPECT_TRUE(built->collapsed(3));
  EXPECT_TRUE(built->collapsed(13));
  EXPECT_EQ(built->unit_normal_q30[3], Int3(0));
  EXPECT_EQ(built->neighbour_begin[3], built->neighbour_begin[4]);
  EXPECT_TRUE(built->closed) << "collapsed triangles are left out";
}

TEST(Weld, WhatSinglePrecisionLeavesNothingOfIsToldWhere) {
  const auto refused = [](double at) {
    const Mesh mesh{{Vec3(at, 0, 0), Vec3(at, 0, 0), Vec3(at, 0, 0)}, {{0, 1, 2}}, {{"a", 0, 1}}};
    return snap_and_weld(mesh, {.step_m = 0x1p-28, .origin_m = Vec3(at, 0, 0)}).error().sentence;
  };
  EXPECT_EQ(refused(1), "all 1 triangles collapse on the lattice (step 3.725290298461914e-09 m)");
  // 2^20 m, where floats are 2^-3 m apart.
  EXPECT_EQ(refused(1048576),
            "all 1 triangles collapse on the lattice (step 3.725290298461914e-09 m); they lie 1.05e+06 m "
            "from their "
            "origin, where single precision has steps of 0.12 m");
}

TEST(Normals, WeightIsTheInverseOfTheDominantComponent) {
  const Mesh mesh = triangle({0, 0, 0}, {1, 0, 1}, {0, 1, 0});  // normal (−1, 0, 1): a tie between x and z
  MeshReport report;
  const auto built = build_lattice_mesh(mesh, choose_lattice(mesh, {}).value(), {}, report);
  ASSERT_TRUE(built);
  EXPECT_EQ(built->sample_axis[0], 0);
  EXPECT_EQ(built->sample_weight_q30[0], static_cast<std::uint32_t>(std::nearbyint(std::sqrt(2.0) * 0x1p30)));
  EXPECT_EQ(built->unit_normal_q30[0], Int3(-759250125, 0, 759250125));  // 2^30 / √2, rounded
}

TEST(Grid, LeavesTwoVoxelsBelowAndThreeAbove) {
  const VoxelGrid grid = make_grid(Int3(-17, 0, 16), Int3(15, 160, 31), 16);
  EXPECT_EQ(grid.origin, Int3(-64, -32, -16));
  // x: floor(15/16) + 3 + 4 = 7 voxels; y: 10 + 3 + 2 = 15; z: 1 + 3 + 1 = 5.
  EXPECT_EQ(grid.bricks, Int3(1, 2, 1));
}

TEST(VoxelSize, AutoDependsOnGeometryAloneAndIsEven) {
  const Mesh mockup = solids::sphere(0.3, 100, 50), tool = solids::sphere(0.05, 40, 20);
  const auto one = build_geometry(mockup, tool, {}), two = build_geometry(mockup, tool, {});
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->mockup_grid.size, two->mockup_grid.size);
  EXPECT_EQ(one->mockup_grid.size % 2, 0);
  EXPECT_LE(one->mockup_grid.size * 24, 0.1001 / one->lattice.step_m);
  EXPECT_EQ(one->sample_spacing, one->mockup_grid.size / 4);
  EXPECT_EQ(one->tool_grid.size, one->mockup_grid.size);
}

// So a coarse voxel, set to save memory, leaves the force as it is.
TEST(VoxelSize, SamplesLieNoFurtherApartWhereVoxelsAreCoarse) {
  const Mesh mockup = solids::sphere(0.3, 100, 50), tool = solids::sphere(0.05, 40, 20);
  const auto usual = build_geometry(mockup, tool, {});
  ASSERT_TRUE(usual);
  const double voxel = usual->mockup_grid.size * usual->lattice.step_m;
  for (const double times : {0.5, 2.0, 15.0, 20.0}) {
    const auto built = build_geometry(mockup, tool, {.voxel_size_m = times * voxel});
    ASSERT_TRUE(built) << times;
    const double steps =
        usual->lattice.step_m / built->lattice.step_m;  // of this lattice, a step of the usual
    const std::int32_t size = built->mockup_grid.size;
    EXPECT_NEAR(size, steps * times * usual->mockup_grid.size, 1) << times;
    const double spacing = times < 1    ? size / 4
                           : times < 16 ? steps * usual->sample_spacing
                                        : std::ceil(size / 63.0);
    EXPECT_NEAR(built->sample_spacing, spacing, steps) << times;
  }
}

TEST(VoxelSize, SettingsBeyondTheLimitsAreRefused) {
  const Mesh mockup = solids::box(Vec3(0), Vec3(1)), tool = solids::sphere(0.05);
  const auto refused = [&](std::optional<double> voxel, std::optional<double> spacing) {
    const auto built = build_geometry(mockup, tool, {.voxel_size_m = voxel, .sample_spacing_m = spacing});
    EXPECT_FALSE(built);
    if (built) return std::string();
    EXPECT_EQ(built.error().code, ErrorCode::kBadValue);
    return built.error().sentence;
  };
  EXPECT_THAT(refused(0.0, {}), HasSubstr("voxel_size is 0 m"));
  EXPECT_THAT(refused(-1.0, {}), HasSubstr("voxel_size is -1 m"));
  EXPECT_THAT(refused(std::nan(""), {}), HasSubstr("voxel_size is nan m"));
  EXPECT_THAT(refused(2.0, {}), HasSubstr("largest side of the scene"));
  EXPECT_THAT(refused(1e-9, {}), HasSubstr("lattice steps"));
  EXPECT_THAT(refused(1e-4, {}), HasSubstr("the limit is"));
  EXPECT_THAT(refused(0.01, 1e-5), HasSubstr("sample_spacing is 1e-05 m"));
  EXPECT_THAT(refused(0.01, std::nan("")), HasSubstr("sample_spacing is nan m"));
}

// Two bodies 100 m apart and a tool of 16 cm: the least of the cost was a voxel of which 70,160 lay along an
// axis.
TEST(VoxelSize, AutoIsUsableByEveryBackEnd) {
  Mesh mockup = solids::box(Vec3(0), Vec3(0.1));
  const Mesh far = solids::box(Vec3(100, 0, 0), Vec3(100.1, 0.1, 0.1)), tool = solids::sphere(0.08, 40, 20);
  const auto vertices = static_cast<std::uint32_t>(mockup.vertices.size());
  for (const auto& [a, b, c] : far.triangles)
    mockup.triangles.push_back({a + vertices, b + vertices, c + vertices});
  mockup.vertices.insert(mockup.vertices.end(), far.vertices.begin(), far.vertices.end());
  mockup.parts = {{"both", 0, static_cast<std::uint32_t>(mockup.triangles.size())}};
  const auto built = build_geometry(mockup, tool, {});
  ASSERT_TRUE(built) << built.error().sentence;
  EXPECT_LE(built->mockup_grid.bricks.x, kMaxAutoBricksAlong);
  EXPECT_GE(built->mockup_grid.bricks.x, kMaxAutoBricksAlong / 2);  // no larger than need be
}

TEST(VoxelSize, ALargeVoxelStillFitsTheLattice) {
  const auto built =
      build_geometry(solids::box(Vec3(0), Vec3(1)), solids::sphere(0.05), {.voxel_size_m = 1.0});
  ASSERT_TRUE(built) << built.error().sentence;
  EXPECT_NEAR(built->mockup_grid.size * built->lattice.step_m, 1.0, 2 * built->lattice.step_m);
  EXPECT_LE(reach_of(built->mockup_grid) + 2 * std::int64_t{built->tool_radius}, kLatticeReach);
}

TEST(VoxelSize, ATinyToolInAVastMockupStillFitsTheLattice) {
  // Memory wants voxels of centimetres, a 24th of the tool is 42 µm: the lattice must make room for the
  // former. Many sheets make the area, and so the voxels, large; the sizes are chosen so that the first
  // lattice just fits.
  for (const double size : {1.0, 1.4, 1.99}) {
    Mesh mockup;
    for (int i = 0; i < 400; ++i)
      solids::append(
          mockup, solids::box(Vec3(0, 0, size * i / 400), Vec3(size, size, size * (i + 0.5) / 400)), "plate");
    const auto built = build_geometry(mockup, solids::sphere(0.0005), {});
    ASSERT_TRUE(built) << built.error().sentence;
    EXPECT_GT(built->mockup_grid.size * built->lattice.step_m, 0.001);
    EXPECT_LE(reach_of(built->mockup_grid) + 2 * std::int64_t{built->tool_radius}, kLatticeReach);
  }
}

TEST(BuildGeometry, BadMeshesAreOneSentence) {
  const Mesh good = solids::box(Vec3(0), Vec3(1));
  Mesh nan = good, index = good, huge = good, point = triangle(Vec3(1), Vec3(1), Vec3(1)), empty;
  nan.vertices[3].y = std::nan("");
  index.triangles[2][1] = 812;
  huge.vertices[0].x = 1e300;
  const auto sentence = [&](const Mesh& mockup, const Mesh& tool) {
    const auto built = build_geometry(mockup, tool, {});
    EXPECT_FALSE(built);
    if (built) return std::string();
    EXPECT_EQ(built.error().code, ErrorCode::kBadValue);
    return built.error().sentence;
  };
  EXPECT_THAT(sentence(nan, good), HasSubstr("mock-up, vertex 3: coordinate nan m"));
  EXPECT_THAT(sentence(good, index), HasSubstr("tool, triangle 2: vertex index 812"));
  EXPECT_THAT(sentence(huge, good), HasSubstr("1e+300"));
  EXPECT_THAT(sentence(point, good), HasSubstr("largest side is 0 m"));
  EXPECT_THAT(sentence(good, point), HasSubstr("tool: all 1 triangles collapse"));
  EXPECT_THAT(sentence(empty, good), HasSubstr("the mock-up has no triangles"));
}

TEST(CentreOfMass, OfTheVolumeWhenClosedElseOfTheArea) {
  const Mesh mockup = solids::box(Vec3(0), Vec3(1));
  const Mesh box = solids::box(Vec3(5), Vec3(5.2, 5.4, 5.6));
  const auto closed = build_geometry(mockup, box, {});
  ASSERT_TRUE(closed);
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(closed->tool_gc_m[k], (box.vertices[0] + Vec3(0.1, 0.2, 0.3))[k], 2 * closed->lattice.step_m);
  Mesh open = box;
  open.triangles.resize(10);
  open.parts[0].triangle_count = 10;
  const auto lid_off = build_geometry(mockup, open, {});
  ASSERT_TRUE(lid_off);
  EXPECT_FALSE(lid_off->tool.closed);
  EXPECT_THAT(lid_off->tool_report.notes, testing::Contains(HasSubstr("area's centroid")));
  const auto far = build_geometry(mockup, box, {.centre_of_mass_m = Vec3(500, 0, 0)});
  ASSERT_FALSE(far);
  EXPECT_THAT(far.error().sentence, HasSubstr("centre_of_mass (500, 0, 0) m"));
}

}  // namespace
}  // namespace palpate
