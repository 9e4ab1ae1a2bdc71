#include <algorithm>
#include <cmath>
#include <memory>

#include "compute/gpu/gpu_backend.h"
#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/native/native_backend.h"
#include "compute/native/prepare/scene.h"
#include "cpu_ref/ref_backend.h"
#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/partition_equality.h"

namespace palpate {
namespace {

/// All engines prepare a mock-up and a tool. The partitions of both must be the same, bit for bit; each
/// test then adds what is known without a reference.
class Partition : public GpuTest {
 protected:
  void prepare(const Mesh& mockup, double voxel_m, const Mesh& tool = solids::box(Vec3(-0.02), Vec3(0.02))) {
    GeometrySettings settings;
    settings.voxel_size_m = voxel_m;
    settings.sample_spacing_m =
        voxel_m / 4;  // for so small a tool they would lie closer, in tens of millions
    auto geometry = build_geometry(mockup, tool, settings);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    geometry_ = std::move(*geometry);
    auto scene = prepare_scene(device(), geometry_, Plan{}, {});
    ASSERT_TRUE(scene) << scene.error().sentence;
    auto native = native::prepare_scene(geometry_, Plan{}, {});
    ASSERT_TRUE(native) << native.error().sentence;
    auto ref = make_ref_backend();
    auto ref_done = ref->prepare(geometry_, Plan{}, {});
    ASSERT_TRUE(ref_done) << ref_done.error().sentence;
    compare(*scene, *native, *ref, false);
    compare(*scene, *native, *ref, true);
    expect_equal_tables(device(), *scene, *native);
    EXPECT_EQ(scene->mockup.partition.has_internal, count(VoxelClass::kInternal) > 0);
  }

  std::uint64_t count(VoxelClass c) const {
    return static_cast<std::uint64_t>(std::count(partition_.classes.begin(), partition_.classes.end(), c));
  }
  /// Class of the voxel that holds a point of the world, m.
  VoxelClass at(const Vec3& point) const {
    const VoxelGrid& g = partition_.grid;
    std::uint64_t number = 0;
    for (int k = 2; k >= 0; --k) {
      const double lattice = (point[k] - geometry_.lattice.origin_m[k]) / geometry_.lattice.step_m;
      const auto i = static_cast<std::int64_t>(std::floor((lattice - g.origin[k]) / g.size));
      number = number * static_cast<std::uint64_t>(g.voxels()[k]) + static_cast<std::uint64_t>(i);
    }
    return partition_.classes[number];
  }

  SceneGeometry geometry_;
  VoxelPartition partition_;  ///< the mock-up's
  VoxelPartition tool_partition_;

 private:
  void compare(const PreparedScene& scene, const native::Scene& native, const CollisionBackend& ref,
               bool tool) {
    const char* body = tool ? "tool" : "mock-up";
    const auto on_device = read_partition(device(), (tool ? scene.tool : scene.mockup).partition);
    ASSERT_TRUE(on_device) << on_device.error().sentence;
    expect_equal(*on_device, tool ? native.tool : native.mockup, body);
    auto got = dense(*on_device);
    auto want = ref.partition(tool);
    ASSERT_TRUE(want) << want.error().sentence;
    EXPECT_TRUE(got.classes == want->classes) << body;
    EXPECT_TRUE(got.boundary_voxels == want->boundary_voxels) << body;
    EXPECT_TRUE(got.list_begin == want->list_begin) << body;
    EXPECT_TRUE(got.list_triangles == want->list_triangles) << body;
    (tool ? tool_partition_ : partition_) = std::move(got);
  }
};

TEST_F(Partition, OfABoxHasTheVoxelsThatItsFacesTouch) {
  // 0.125 and 1/64 are whole numbers of lattice steps: faces lie on faces of voxels and touch those on both
  // sides.
  prepare(solids::box(Vec3(-0.125), Vec3(0.125)), 1.0 / 64);
  const std::uint64_t outer = 18 * 18 * 18, inner = 14 * 14 * 14;
  EXPECT_EQ(count(VoxelClass::kInternal), inner);
  EXPECT_EQ(count(VoxelClass::kBoundary), outer - inner);
}

TEST_F(Partition, OfASphereHoldsItsVolumeBetweenInsideAndSkin) {
  const Mesh ball = solids::sphere(0.05, 48, 24);
  prepare(ball, 0.002);
  const double voxel = static_cast<double>(geometry_.mockup_grid.size) * geometry_.lattice.step_m;
  const double inside = static_cast<double>(count(VoxelClass::kInternal)) * voxel * voxel * voxel;
  const double skin = static_cast<double>(count(VoxelClass::kBoundary)) * voxel * voxel * voxel;
  EXPECT_GT(inside, 0);
  EXPECT_LT(inside, solids::volume(ball));
  EXPECT_GT(inside + skin, solids::volume(ball));
}

TEST_F(Partition, OfNestedShellsCountsWindingsNotParity) {
  Mesh mesh;
  solids::append(mesh, solids::sphere(0.2, 24, 12), "outer");
  solids::append(mesh, solids::sphere(0.1, 24, 12), "inner, outward too: winding 2");
  prepare(mesh, 0.01);
  EXPECT_EQ(at(Vec3(0.003)), VoxelClass::kInternal);
  EXPECT_EQ(at(Vec3(0.153, 0.003, 0.003)), VoxelClass::kInternal);
}

TEST_F(Partition, OfAHollowHasExternalVoxelsFarFromTheBorder) {
  Mesh both;
  solids::append(both, solids::box(Vec3(-0.125), Vec3(0.125)), "wall");
  Mesh hollow = solids::box(Vec3(-0.0625, -0.0625, -0.03125), Vec3(0.0625));
  for (auto& t : hollow.triangles) std::swap(t[0], t[1]);
  solids::append(both, hollow, "hollow, facing inwards");
  prepare(both, 1.0 / 256);
  EXPECT_EQ(at(Vec3(0)), VoxelClass::kExternal);
  EXPECT_EQ(at(Vec3(-0.09)), VoxelClass::kInternal);
}

TEST_F(Partition, OfOverlappingBoxesIsInsideInTheOverlapToo) {
  Mesh mesh;
  solids::append(mesh, solids::box(Vec3(-0.2), Vec3(0.1)), "a");
  solids::append(mesh, solids::box(Vec3(-0.1), Vec3(0.2)), "b");
  prepare(mesh, 0.01);
  EXPECT_EQ(at(Vec3(0.003)), VoxelClass::kInternal);
  EXPECT_EQ(at(Vec3(-0.153)), VoxelClass::kInternal);
  EXPECT_EQ(at(Vec3(0.153)), VoxelClass::kInternal);
}

TEST_F(Partition, OfAPotIsExternalInsideAsItIsOpenToTheBorder) {
  Mesh pot = solids::box(Vec3(-0.2), Vec3(0.2));
  std::erase_if(pot.triangles, [&](const auto& t) {
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return pot.vertices[v].z > 0.19; });
  });
  pot.parts = {{"", 0, static_cast<std::uint32_t>(pot.triangles.size())}};
  ASSERT_EQ(pot.triangles.size(), 10u);
  prepare(pot, 0.01);
  EXPECT_EQ(count(VoxelClass::kInternal), 0u);
}

TEST_F(Partition, OfAnOpenBodyIsVotedInThreeDirections) {
  // A hole smaller than a voxel: closed for voxels, but some rays leave through it and find winding 0.
  Mesh ball = solids::sphere(0.2, 96, 48);
  ball.triangles.erase(ball.triangles.begin() + static_cast<std::ptrdiff_t>(ball.triangles.size() / 2));
  ball.parts = {{"", 0, static_cast<std::uint32_t>(ball.triangles.size())}};
  prepare(ball, 0.03);
  EXPECT_FALSE(geometry_.mockup.closed);
  EXPECT_EQ(at(Vec3(0.003)), VoxelClass::kInternal);
}

TEST_F(Partition, OfAnOpenBodyDecidesARayThroughACornerByThePerturbedPoint) {
  // A cube round one voxel, its faces cut so that the ray from the voxel's centre along each axis leaves
  // through a corner of six triangles. The face of the next axis has a clear hole there, so two of three
  // ballots hang on this one: of the six, the one that the perturbed ray meets must be missing to make the
  // voxel external.
  constexpr double kV = 1.0 / 64;
  const Vec3 centre(kV / 2);
  const Mesh cube = solids::box(centre - kV, centre + kV, Int3(4));
  const auto touches = [&](const std::array<std::uint32_t, 3>& t, const Vec3& point) {
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return cube.vertices[v] == point; });
  };
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 through = centre, clear = centre;
    through[axis] += kV;
    clear[(axis + 1) % 3] += kV;
    std::vector<std::size_t> round_corner;
    for (std::size_t i = 0; i < cube.triangles.size(); ++i)
      if (touches(cube.triangles[i], through)) round_corner.push_back(i);
    ASSERT_GE(round_corner.size(), 4u);
    int external = 0;
    for (const std::size_t missing : round_corner) {
      Mesh mesh;
      Mesh holed = cube;
      holed.triangles.clear();
      for (std::size_t i = 0; i < cube.triangles.size(); ++i)
        if (i != missing && !touches(cube.triangles[i], clear)) holed.triangles.push_back(cube.triangles[i]);
      solids::append(mesh, holed, "cube with holes");
      // Two beads keep the lattice's origin, and with it the grid, where the cube was drawn for.
      solids::append(mesh, solids::box(Vec3(8 * kV), Vec3(8.25 * kV)), "bead");
      solids::append(mesh, solids::box(Vec3(-8.25 * kV), Vec3(-8 * kV)), "bead");
      prepare(mesh, kV);
      ASSERT_NE(at(centre), VoxelClass::kBoundary);
      external += at(centre) == VoxelClass::kExternal;
    }
    EXPECT_EQ(external, 1) << "axis " << axis;
  }
}

TEST_F(Partition, OfLargeTrianglesAmongSmallOnes) {
  // Boxes of twelve triangles over 20 bricks an axis, turned so that nothing is parallel to the grid.
  Mesh mesh;
  const Quat turn = glm::normalize(Quat(0.9, 0.2, -0.3, 0.25));
  solids::append(mesh,
                 solids::moved(solids::box(Vec3(-0.4, -0.3, -0.2), Vec3(0.4, 0.3, 0.2)), Pose{Vec3(0), turn}),
                 "block");
  solids::append(mesh, solids::sphere(0.45, 40, 20), "ball");
  prepare(mesh, 0.006);
  EXPECT_GT(partition_.grid.bricks.x, 16);
}

TEST_F(Partition, SortsListsOfAnyLength) {
  // A ball of 6,000 triangles in a voxel or eight, beside a block that makes the grid.
  Mesh mesh;
  solids::append(mesh, solids::box(Vec3(-0.3), Vec3(0.3)), "block");
  solids::append(mesh,
                 solids::moved(solids::sphere_of(0.02, 6000), Pose{Vec3(0.41, 0.02, 0.01), Quat(1, 0, 0, 0)}),
                 "bead");
  prepare(mesh, 0.1);
  std::uint64_t longest = 0;
  for (std::size_t i = 0; i + 1 < partition_.list_begin.size(); ++i)
    longest = std::max(longest, partition_.list_begin[i + 1] - partition_.list_begin[i]);
  EXPECT_GT(longest, 2000u);
}

TEST_F(Partition, OfAToolIsGrownByThreeSteps) {
  prepare(solids::box(Vec3(-0.3), Vec3(0.3)), 0.01, solids::torus(0.08, 0.03, 40, 20));
  EXPECT_GT(std::count(tool_partition_.classes.begin(), tool_partition_.classes.end(), VoxelClass::kInternal),
            0);
}

/// Both engines.
std::vector<std::unique_ptr<CollisionBackend>> engines() {
  std::vector<std::unique_ptr<CollisionBackend>> out;
  auto gpu = make_gpu_backend({});
  EXPECT_TRUE(gpu) << gpu.error().sentence;
  if (gpu) out.push_back(std::move(*gpu));
  out.push_back(make_native_backend());
  return out;
}

TEST(Preparation, CanBeCancelled) {
  auto geometry = build_geometry(solids::sphere(0.2), solids::box(Vec3(-0.01), Vec3(0.01)), {});
  ASSERT_TRUE(geometry);
  for (const auto& engine : engines())
    for (const double at : {0.0, 0.35, 0.7, 1.0}) {
      auto done =
          engine->prepare(*geometry, Plan{}, [at](const char*, double progress) { return progress < at; });
      ASSERT_FALSE(done) << engine->name() << " at " << at;
      EXPECT_EQ(done.error().sentence, "preparation was cancelled") << engine->name();
    }
}

TEST(Preparation, RefusesAGridThatDoesNotFit) {
  GeometrySettings settings;
  settings.voxel_size_m = 2e-5;  // 50,000 voxels along the wire
  auto geometry = build_geometry(solids::box(Vec3(-0.5, 0, 0), Vec3(0.5, 1e-5, 1e-5)),
                                 solids::box(Vec3(-1e-4), Vec3(1e-4)), settings);
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  for (const auto& engine : engines()) {
    auto done = engine->prepare(*geometry, Plan{}, {});
    ASSERT_FALSE(done) << engine->name();
    EXPECT_NE(done.error().sentence.find("choose a larger voxel"), std::string::npos)
        << done.error().sentence;
  }
}

TEST(Devices, AreListedWithAReasonEach) {
  const auto devices = list_vulkan_devices();
  ASSERT_FALSE(devices.empty());
  EXPECT_TRUE(std::any_of(devices.begin(), devices.end(), [](const auto& d) { return d.usable; }));
  for (const auto& d : devices) EXPECT_FALSE(d.reason.empty());
}

TEST(Devices, ANameThatNoDeviceHasIsRefusedWithTheNamesThereAre) {
  GpuOptions options;
  options.device = "Voodoo 2";
  auto gpu = make_gpu_backend(options);
  ASSERT_FALSE(gpu);
  EXPECT_EQ(gpu.error().code, ErrorCode::kNoDevice);
  EXPECT_NE(gpu.error().sentence.find("not named \"Voodoo 2\""), std::string::npos) << gpu.error().sentence;
}

}  // namespace
}  // namespace palpate
