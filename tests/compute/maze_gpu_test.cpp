#include <algorithm>
#include <cstdlib>

#include "compute/gpu/prepare/prepared_scene.h"
#include "compute/native/prepare/scene.h"
#include "cpu_ref/ref_backend.h"
#include "tests/compute/gpu_test.h"
#include "tests/compute/module_run.h"
#include "tests/compute/partition_equality.h"
#include "tests/equivalence/lattice_shapes.h"

namespace palpate {
namespace {

using equivalence::LatticeTriangle;
using equivalence::Triangles;

/// Cells with walls between most of them: open for rays and shut for voxels, as no two walls have an edge in
/// common; each faces one way or the other, so that windings come out as anything and votes are near. Some
/// lack a triangle, which may let the outside in. Walls lie on voxels' faces, in their centres, or a step
/// beside.
class Maze {
 public:
  Maze(Numbers& random, std::int32_t voxel) : random_(random), voxel_(voxel) {
    const int shut = between(55, 97);
    for (int k = 0; k < 3; ++k) {
      planes_[k].push_back(between(-3, 3) * voxel / 2);
      for (int cells = between(1, 5); cells > 0; --cells) {
        const int halves = random_() % 16 == 0
                               ? between(40, 70)
                               : between(2, 26);  // of a voxel; a wide cell has room for bricks
        planes_[k].push_back(planes_[k].back() + halves * voxel / 2 +
                             (random_() % 3 == 0 ? between(-1, 1) : 0));
      }
    }
    for (int k = 0; k < 3; ++k)
      for (const std::int32_t plane : planes_[k])
        for (std::size_t i = 0; i + 1 < planes_[(k + 1) % 3].size(); ++i)
          for (std::size_t j = 0; j + 1 < planes_[(k + 2) % 3].size(); ++j)
            if (between(0, 99) < shut) wall(k, plane, i, j);
    for (int more = between(0, 6); more > 0; --more)
      triangles_.push_back({anywhere(), anywhere(), anywhere()});
    if (triangles_.empty()) triangles_.push_back({{0, 0, 0}, {voxel, 0, 0}, {0, voxel, 0}});
  }

  const Triangles& triangles() const { return triangles_; }

 private:
  int between(int least, int most) {
    return least + static_cast<int>(random_() % static_cast<unsigned>(most - least + 1));
  }
  Int3 anywhere() {
    Int3 p;
    for (int k = 0; k < 3; ++k)
      p[k] = planes_[k].front() +
             between(0, (planes_[k].back() - planes_[k].front()) / (voxel_ / 2)) * (voxel_ / 2);
    return p;
  }
  void wall(int k, std::int32_t plane, std::size_t i, std::size_t j) {
    const int u = (k + 1) % 3, v = (k + 2) % 3, slit = between(0, 2);
    const auto corner = [&](bool far_u, bool far_v) {
      Int3 p;
      p[k] = plane;
      p[u] = planes_[u][i + far_u] + (far_u ? -slit : slit);
      p[v] = planes_[v][j + far_v] + (far_v ? -slit : slit);
      return p;
    };
    Int3 ring[4] = {corner(false, false), corner(true, false), corner(true, true), corner(false, true)};
    std::rotate(ring, ring + between(0, 1), ring + 4);
    if (random_() % 2 == 0) std::reverse(ring, ring + 4);
    if (random_() % 12 != 0) triangles_.push_back({ring[0], ring[1], ring[2]});
    triangles_.push_back({ring[0], ring[2], ring[3]});
  }

  Numbers& random_;
  std::int32_t voxel_;
  std::vector<std::int32_t> planes_[3];
  Triangles triangles_;
};

class Mazes : public GpuTest {
 protected:
  void prepare(std::uint32_t seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Numbers random(seed);
    const std::int32_t voxel = 8 << random() % 4;
    const Maze mockup(random, voxel);
    const Triangles tool =
        seed % 3 == 0 ? Maze(random, voxel).triangles() : equivalence::box_of(Int3(-voxel), Int3(voxel));
    const auto geometry = equivalence::lattice_scene(mockup.triangles(), tool, voxel, voxel / 2);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    auto cpu = make_ref_backend();
    ASSERT_TRUE(cpu->prepare(*geometry, Plan{}, {}));
    const auto scene = prepare_scene(device(), *geometry, Plan{}, {});
    ASSERT_TRUE(scene) << scene.error().sentence;
    const auto native = native::prepare_scene(*geometry, Plan{}, {});
    ASSERT_TRUE(native) << native.error().sentence;
    for (const bool of_tool : {false, true}) {
      const char* body = of_tool ? "tool" : "mock-up";
      const auto on_device = read_partition(device(), (of_tool ? scene->tool : scene->mockup).partition);
      const auto want = cpu->partition(of_tool);
      ASSERT_TRUE(on_device && want);
      expect_equal(*on_device, of_tool ? native->tool : native->mockup, body);
      const VoxelPartition got = dense(*on_device);
      ASSERT_TRUE(got.classes == want->classes) << body;
      ASSERT_TRUE(got.list_begin == want->list_begin && got.list_triangles == want->list_triangles) << body;
      internal_ += static_cast<std::uint64_t>(
          std::count(want->classes.begin(), want->classes.end(), VoxelClass::kInternal));
    }
    expect_equal_tables(device(), *scene, *native);
  }
  std::uint64_t internal_ = 0;  ///< voxels of V_int so far
};

TEST_F(Mazes, ArePreparedLikeTheReferences) {
  const char* seeds = std::getenv("PALPATE_MAZES");  // more of them, by hand
  const std::uint32_t count = seeds != nullptr ? static_cast<std::uint32_t>(std::atoi(seeds)) : 16;
  for (std::uint32_t seed = 1; seed <= count && !HasFatalFailure(); ++seed) prepare(seed);
  EXPECT_GT(internal_, 10'000u);
}

}  // namespace
}  // namespace palpate
