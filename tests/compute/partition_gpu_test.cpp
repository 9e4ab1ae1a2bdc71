#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "compute/gpu_backend.h"
#include "cpu_ref/cpu_backend.h"
#include "model/generate/solids.h"
#include "model/geometry_build.h"

namespace palpate {
namespace {

/// Both back ends prepare a mock-up and a tool; the GPU's partitions are returned after they agreed with the reference's.
class Partition : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    GpuOptions options;
    options.validation = true;
    auto made = make_gpu_backend(options);
    ASSERT_TRUE(made) << made.error().sentence;
    gpu_ = std::move(*made);
  }
  static void TearDownTestSuite() { gpu_.reset(); }
  void SetUp() override { ASSERT_NE(gpu_, nullptr); }

  void prepare(const Mesh& mockup, const Mesh& tool, double voxel_m) {
    GeometrySettings settings;
    settings.voxel_size_m = voxel_m;
    auto geometry = build_geometry(mockup, tool, settings);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    geometry_ = std::move(*geometry);
    Plan plan;
    auto done = gpu_->prepare(geometry_, plan, {});
    ASSERT_TRUE(done) << done.error().sentence;
    auto cpu = make_cpu_backend();
    auto cpu_done = cpu->prepare(geometry_, plan, {});
    ASSERT_TRUE(cpu_done) << cpu_done.error().sentence;
    compare(*cpu, false);
    compare(*cpu, true);
  }

  std::uint64_t count(VoxelClass c) const {
    return static_cast<std::uint64_t>(std::count(partition_.classes.begin(), partition_.classes.end(), c));
  }

  SceneGeometry geometry_;
  VoxelPartition partition_;        ///< the mock-up's
  VoxelPartition tool_partition_;

 private:
  void compare(const CollisionBackend& cpu, bool tool) {
    auto got = gpu_->partition(tool);
    ASSERT_TRUE(got) << got.error().sentence;
    auto want = cpu.partition(tool);
    ASSERT_TRUE(want) << want.error().sentence;
    ASSERT_EQ(got->classes.size(), want->classes.size());
    EXPECT_TRUE(got->classes == want->classes) << (tool ? "tool" : "mock-up");
    EXPECT_TRUE(got->boundary_voxels == want->boundary_voxels) << (tool ? "tool" : "mock-up");
    EXPECT_TRUE(got->list_begin == want->list_begin) << (tool ? "tool" : "mock-up");
    EXPECT_TRUE(got->list_triangles == want->list_triangles) << (tool ? "tool" : "mock-up");
    (tool ? tool_partition_ : partition_) = std::move(*got);
  }
  static inline std::unique_ptr<CollisionBackend> gpu_;
};

TEST_F(Partition, OfASphereHasTheVolumeOfTheBallInside) {
  prepare(solids::sphere(0.05, 48, 24), solids::box(Vec3(-0.01), Vec3(0.01)), 0.002);
  EXPECT_GT(count(VoxelClass::kInternal), 0u);
  const double voxel = static_cast<double>(geometry_.mockup_grid.size) * geometry_.lattice.step_m;
  const double inside = static_cast<double>(count(VoxelClass::kInternal)) * voxel * voxel * voxel;
  const double with_skin = inside + static_cast<double>(count(VoxelClass::kBoundary)) * voxel * voxel * voxel;
  const double volume = solids::volume(solids::sphere(0.05, 48, 24));
  EXPECT_LT(inside, volume);
  EXPECT_GT(with_skin, volume);
}

}  // namespace
}  // namespace palpate
