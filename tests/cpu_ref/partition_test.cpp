#include "cpu_ref/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cpu_ref/ray.h"
#include "cpu_ref/triangle_cube.h"
#include "tests/cpu_ref/lattice_scene.h"

namespace palpate::cpu_ref {
namespace {

Partition partition_of(const LatticeMesh& mesh, int size, int grow = 0) {
  auto made = make_partition(mesh, make_grid(mesh.box_min, mesh.box_max, size), grow, {});
  if (!made) throw std::runtime_error(made.error().sentence);
  return std::move(*made);
}

std::uint64_t voxel_count(const Partition& partition) {
  const Int3 n = partition.grid.voxels();
  return partition.number(n - Int3(1)) + 1;
}

std::vector<Triangle> inside_out(std::vector<Triangle> body) {
  for (Triangle& t : body) t = Triangle(t[0], t[2], t[1]);
  return body;
}

/// The definition, word by word and slowly: one voxel at a time.
void expect_as_defined(const LatticeMesh& mesh, const Partition& partition, int grow) {
  const Int3 n = partition.grid.voxels();
  std::vector<VoxelClass> expected(voxel_count(partition), VoxelClass::kInternal);
  std::vector<std::uint64_t> border;
  for (std::uint64_t v = 0; v < expected.size(); ++v) {
    const Int3 voxel = partition.voxel(v);
    ASSERT_EQ(partition.number(voxel), v);
    std::vector<std::uint32_t> listed;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      if (!mesh.collapsed(t) &&
          triangle_meets_box(triangle_of(mesh, t), voxel_box(partition.grid, voxel, voxel + Int3(1), grow)))
        listed.push_back(t);
    const auto found = partition.listed(v);
    ASSERT_TRUE(std::equal(listed.begin(), listed.end(), found.begin(), found.end()));
    if (!listed.empty()) expected[v] = VoxelClass::kBoundary;
    for (int k = 0; k < 3; ++k)
      if (voxel[k] == 0 || voxel[k] == n[k] - 1) border.push_back(v);
  }
  // V_ext spreads from the border.
  for (const std::uint64_t v : border) ASSERT_NE(expected[v], VoxelClass::kBoundary);
  std::vector<std::uint64_t> open = border;
  for (const std::uint64_t v : open) expected[v] = VoxelClass::kExternal;
  const auto spread = [&](std::vector<std::uint64_t> from, VoxelClass to,
                          std::vector<std::uint64_t>& reached) {
    while (!from.empty()) {
      const Int3 voxel = partition.voxel(from.back());
      reached.push_back(from.back());
      from.pop_back();
      for (int k = 0; k < 3; ++k)
        for (const int step : {-1, 1}) {
          Int3 next = voxel;
          next[k] += step;
          if (!partition.in_grid(next) || expected[partition.number(next)] != VoxelClass::kInternal) continue;
          expected[partition.number(next)] = to;
          from.push_back(partition.number(next));
        }
    }
  };
  std::vector<std::uint64_t> reached;
  spread(open, VoxelClass::kExternal, reached);
  // Every other component votes.
  constexpr VoxelClass kSeen{9};
  for (std::uint64_t v = 0; v < expected.size(); ++v) {
    if (expected[v] != VoxelClass::kInternal) continue;
    expected[v] = kSeen;
    std::vector<std::uint64_t> component;
    spread({v}, kSeen, component);
    int zero = 0, other = 0;
    for (const std::uint64_t c : component)
      for (int k = 0; k < (mesh.closed ? 1 : 3); ++k) {
        Int3 direction(0);
        direction[k] = 1;
        int winding = 0;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
          if (!mesh.collapsed(t))
            if (const auto crossing =
                    ray_crosses(partition.centre(partition.voxel(c)), direction, triangle_of(mesh, t)))
              winding += crossing->sign;
        ++(winding == 0 ? zero : other);
      }
    for (const std::uint64_t c : component) expected[c] = static_cast<VoxelClass>(other > zero ? 32 : 33);
  }
  for (VoxelClass& c : expected)
    if (c > kSeen) c = static_cast<int>(c) == 32 ? VoxelClass::kInternal : VoxelClass::kExternal;
  EXPECT_EQ(partition.dense()->classes, expected);
  EXPECT_EQ(partition.has_internal, std::count(expected.begin(), expected.end(), VoxelClass::kInternal) > 0);
}

TEST(Partition, ABoxHasAnInside) {
  const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-40), Int3(40)));
  const Partition partition = partition_of(mesh, 8);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kInternal);
  EXPECT_EQ(partition.class_of(Int3(39, 0, 0)), VoxelClass::kBoundary);
  EXPECT_EQ(partition.class_of(Int3(40, 0, 0)),
            VoxelClass::kBoundary);  // the face is on the border of two voxels
  EXPECT_EQ(partition.class_of(Int3(48, 0, 0)), VoxelClass::kExternal);
  EXPECT_EQ(partition.class_of(Int3(100000, 0, 0)), VoxelClass::kExternal);
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, GrownCubesTouchThreeStepsFurther) {
  const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-36), Int3(35)));
  expect_as_defined(mesh, partition_of(mesh, 8, 3), 3);
}

TEST(Partition, ACavityIsOutside) {
  const LatticeMesh mesh = lattice_mesh_of(
      together({lattice_box(Int3(-60), Int3(60)), inside_out(lattice_box(Int3(-24), Int3(24)))}));
  ASSERT_TRUE(mesh.closed);
  const Partition partition = partition_of(mesh, 8);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kExternal);
  EXPECT_EQ(partition.class_of(Int3(44, 0, 0)), VoxelClass::kInternal);
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, ASolidInsideASolidIsInside) {
  const LatticeMesh mesh =
      lattice_mesh_of(together({lattice_box(Int3(-60), Int3(60)), lattice_box(Int3(-24), Int3(24))}));
  const Partition partition = partition_of(mesh, 8);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kInternal);  // winding 2: parity would say outside
  EXPECT_EQ(partition.class_of(Int3(44, 0, 0)), VoxelClass::kInternal);
}

TEST(Partition, OverlappingPartsAreOneInside) {
  const LatticeMesh mesh = lattice_mesh_of(together({lattice_box(Int3(-60, -40, -40), Int3(20, 40, 40)),
                                                     lattice_box(Int3(-20, -36, -36), Int3(60, 36, 36))}));
  const Partition partition = partition_of(mesh, 8);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kInternal);
  EXPECT_EQ(partition.class_of(Int3(-44, 0, 0)), VoxelClass::kInternal);
  EXPECT_EQ(partition.class_of(Int3(44, 0, 0)), VoxelClass::kInternal);
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, AnOpenBoxWithAGapOfLessThanAVoxelVotesForItsInside) {
  // The lid is drawn in to leave slits of 3 steps, far less than a voxel: no voxel leads out.
  std::vector<Triangle> box = lattice_box(Int3(-60), Int3(60));
  for (Triangle& t : box) {
    if (t[0].z != 60 || t[1].z != 60 || t[2].z != 60) continue;
    for (Int3& c : t.corners) c = Int3(c.x / 60 * 57, c.y, c.z);
    t = Triangle(t[0], t[1], t[2]);
  }
  const LatticeMesh mesh = lattice_mesh_of(box);
  ASSERT_FALSE(mesh.closed);
  const Partition partition = partition_of(mesh, 12);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kInternal);
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, AnOpenBoxHasNoInside) {
  std::vector<Triangle> box = lattice_box(Int3(-60), Int3(60));
  std::erase_if(box, [](const Triangle& t) { return t[0].z == 60 && t[1].z == 60 && t[2].z == 60; });
  ASSERT_EQ(box.size(), 10u);
  const Partition partition = partition_of(lattice_mesh_of(box), 12);
  EXPECT_FALSE(partition.has_internal);
  EXPECT_EQ(partition.class_of(Int3(0)), VoxelClass::kExternal);
}

TEST(Partition, RandomSoupsAreAsDefined) {
  std::mt19937 random(23);
  std::uniform_int_distribution<int> draw(-36, 36);
  for (int i = 0; i < 6; ++i) {
    std::vector<Triangle> soup;
    for (int t = 0; t < 60; ++t)
      soup.emplace_back(Int3(draw(random), draw(random), draw(random)),
                        Int3(draw(random), draw(random), draw(random)),
                        Int3(draw(random), draw(random), draw(random)));
    const LatticeMesh mesh = lattice_mesh_of(soup);
    expect_as_defined(mesh, partition_of(mesh, 8), 0);
  }
}

TEST(Partition, TheOutermostLayerIsNeverBoundary) {
  for (const int size : {8, 10, 26}) {
    const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-40, -41, -39), Int3(40, 41, 52)));
    const Partition partition = partition_of(mesh, size, 3);
    const Int3 n = partition.grid.voxels();
    for (const std::uint64_t v : partition.boundary_voxels)
      for (int k = 0; k < 3; ++k) {
        EXPECT_GT(partition.voxel(v)[k], 0);
        EXPECT_LT(partition.voxel(v)[k], n[k] - 1);
      }
  }
}

TEST(Partition, TooManyVoxelsAreRefusedInASentence) {
  const int far = kLatticeReach;
  const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-far), Int3(far)));
  const auto made = make_partition(mesh, make_grid(mesh.box_min, mesh.box_max, 1 << 14), 0, {});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kBadValue);
  EXPECT_NE(made.error().sentence.find("67108864"), std::string::npos);
}

TEST(Partition, BricksWithoutSurfaceAreKeptWhole) {
  // A large box: inside and outside are uniform bricks, of which some are enclosed and vote as a whole.
  const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-200), Int3(200)));
  const Partition partition = partition_of(mesh, 8);
  EXPECT_TRUE(partition.classes.uniform(partition.classes.brick_of(partition.holding(Int3(0)))));
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, AnOpenBoxWithWholeBricksInsideVotesByEveryVoxel) {
  // The lid is drawn in by 3 steps on two sides, and lower than the rim by 5: rays along +z miss it near the
  // rim.
  std::vector<Triangle> box = lattice_box(Int3(-150), Int3(150));
  for (Triangle& t : box) {
    if (t[0].z != 150 || t[1].z != 150 || t[2].z != 150) continue;
    for (Int3& c : t.corners) c = Int3(c.x / 150 * 147, c.y, 145);
    t = Triangle(t[0], t[1], t[2]);
  }
  const LatticeMesh mesh = lattice_mesh_of(box);
  ASSERT_FALSE(mesh.closed);
  const Partition partition = partition_of(mesh, 8);
  EXPECT_TRUE(partition.has_internal);
  EXPECT_TRUE(partition.classes.uniform(partition.classes.brick_of(partition.holding(Int3(0)))));
  expect_as_defined(mesh, partition, 0);
}

TEST(Partition, CanBeCancelled) {
  const LatticeMesh mesh = lattice_mesh_of(lattice_box(Int3(-40), Int3(40)));
  EXPECT_FALSE(make_partition(mesh, make_grid(mesh.box_min, mesh.box_max, 8), 0,
                              [](const char*, double) { return false; }));
}

TEST(NearestExternal, IsTheNearestOfAllAndTheSmallestNumberOfATie) {
  const LatticeMesh mesh = lattice_mesh_of(together(
      {lattice_box(Int3(-60), Int3(60)), inside_out(lattice_box(Int3(-24, -20, -20), Int3(24, 20, 20)))}));
  const Partition partition = partition_of(mesh, 8);
  std::mt19937 random(29);
  std::uniform_int_distribution<int> draw(-150, 150);
  for (int i = 0; i < 60; ++i) {
    const Int3 p(draw(random), draw(random), draw(random) / (1 + i % 3) * 4 / 4);
    std::int64_t nearest = -1;
    Int3 expected(0);
    for (std::uint64_t v = 0; v < voxel_count(partition); ++v) {
      if (partition.classes.at(partition.voxel(v)) != VoxelClass::kExternal) continue;
      const Int3 away = 2 * (partition.centre(partition.voxel(v)) - p);
      const std::int64_t distance =
          std::int64_t{away.x} * away.x + std::int64_t{away.y} * away.y + std::int64_t{away.z} * away.z;
      if (nearest < 0 || distance < nearest) {
        nearest = distance;
        expected = away / 2;
      }
    }
    EXPECT_EQ(partition.to_nearest_external(p), Long3(expected)) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

}  // namespace
}  // namespace palpate::cpu_ref
