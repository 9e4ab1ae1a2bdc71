#include "cpu_ref/samples.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <tuple>

#include "tests/cpu_ref/lattice_scene.h"

namespace palpate::cpu_ref {
namespace {

using Key = std::tuple<int, int, int>;
const Box kEverywhere{Int3(-kLatticeReach), Int3(kLatticeReach)};

/// Every sample of a mesh and how often it occurs.
std::map<Key, int> samples_of(const LatticeMesh& mesh, int spacing, const Box& clip = kEverywhere) {
  std::map<Key, int> samples;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for_each_sample(mesh, t, spacing, clip, [&](const Int3& p) { ++samples[{p.x, p.y, p.z}]; });
  return samples;
}

TEST(Samples, APlateOfTwoAndOf20000TrianglesHasTheSame) {
  const Int3 min(-300, -300, 0), max(300, 300, 0);
  for (const int spacing : {3, 7, 50}) {   // 3 divides the cells of 6: grid points on every edge and corner
    const auto of_two = samples_of(lattice_mesh_of(lattice_plate(min, max, 1)), spacing);
    const auto of_many = samples_of(lattice_mesh_of(lattice_plate(min, max, 100)), spacing);
    EXPECT_EQ(of_two, of_many);
    for (const auto& [point, times] : of_two) EXPECT_EQ(times, 1);
  }
}

TEST(Samples, AreTheGridPointsOfAHalfOpenRectangle) {
  const auto samples = samples_of(lattice_mesh_of(lattice_plate(Int3(-20, -10, 5), Int3(20, 10, 5), 1)), 5);
  std::set<Key> expected;
  for (int x = -20; x < 20; x += 5)
    for (int y = -10; y < 10; y += 5) expected.emplace(x, y, 5);
  ASSERT_EQ(samples.size(), expected.size());
  for (const auto& [point, times] : samples) EXPECT_TRUE(expected.count(point));
}

TEST(Samples, StayTheSameWhenTheTriangleMoves) {
  // Anchored at the lattice's origin, not at the triangle: the grid does not move with it.
  const auto here = samples_of(lattice_mesh_of(lattice_plate(Int3(-21, -21, 0), Int3(21, 21, 0), 1)), 7);
  const auto there = samples_of(lattice_mesh_of(lattice_plate(Int3(-18, -19, 0), Int3(24, 23, 0), 1)), 7);
  for (const auto& [point, times] : there) {
    EXPECT_EQ(std::get<0>(point) % 7, 0);
    EXPECT_EQ(std::get<1>(point) % 7, 0);
  }
  EXPECT_EQ(here.size(), there.size());
}

TEST(Samples, ASlopedTriangleIsRoundedDown) {
  // z = x / 3: N = (−1, 0, 3) direction, axis z.
  const LatticeMesh mesh = lattice_mesh_of({Triangle(Int3(-90, -90, -30), Int3(90, -90, 30), Int3(-90, 90, -30))});
  for (const auto& [point, times] : samples_of(mesh, 7)) {
    const auto [x, y, z] = point;
    EXPECT_EQ(z, static_cast<int>(std::floor(x / 3.0)));
  }
}

TEST(Samples, TurningATriangleRoundKeepsItsSamples) {
  std::mt19937 random(31);
  std::uniform_int_distribution<int> draw(-200, 200);
  for (int i = 0; i < 200; ++i) {
    const Triangle t(Int3(draw(random), draw(random), draw(random)), Int3(draw(random), draw(random), draw(random)),
                     Int3(draw(random), draw(random), draw(random)));
    if (t.collapsed()) continue;
    EXPECT_EQ(samples_of(lattice_mesh_of({t}), 9), samples_of(lattice_mesh_of({Triangle(t[0], t[2], t[1])}), 9));
  }
}

TEST(Samples, AClosedMeshHasEachProjectedPointAsOftenUpAsDown) {
  // Of the faces sampled along one axis alone, edges shared by two of them must count once: on a closed surface whose
  // faces all have that axis no point is lost, and none is double.
  const LatticeMesh mesh = lattice_mesh_of(lattice_octahedron(120));   // ties: every face takes axis x
  std::map<std::pair<int, int>, int> above;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    ASSERT_EQ(mesh.sample_axis[t], 0);
    for_each_sample(mesh, t, 10, kEverywhere, [&](const Int3& p) { above[{p.y, p.z}] += triangle_of(mesh, t).normal.x > 0 ? 1 : -1000; });
  }
  for (const auto& [place, count] : above) EXPECT_EQ(count, 1 - 1000);
  EXPECT_EQ(above.size(), 288u);   // 2·12² points of the square |y| + |z| < 120, half of its border
}

TEST(Samples, ClippingLeavesOutWhatIsOutsideAlone) {
  std::mt19937 random(37);
  std::uniform_int_distribution<int> draw(-200, 200);
  const Box clip{Int3(-50, -70, -60), Int3(90, 40, 80)};
  for (int i = 0; i < 100; ++i) {
    const LatticeMesh mesh = lattice_mesh_of({Triangle(Int3(draw(random), draw(random), draw(random)), Int3(draw(random), draw(random), draw(random)),
                                                       Int3(draw(random), draw(random), draw(random)))});
    auto expected = samples_of(mesh, 6);
    std::erase_if(expected, [&](const auto& entry) {
      const auto [x, y, z] = entry.first;
      const Int3 p(x, y, z);
      return !clip.meets(Box{p, p});
    });
    EXPECT_EQ(samples_of(mesh, 6, clip), expected);
  }
}

TEST(Samples, ATriangleAcrossTheLatticeIsExact) {
  const int far = kLatticeReach;
  const LatticeMesh mesh = lattice_mesh_of({Triangle(Int3(-far, -far, -far), Int3(far, -far, far), Int3(-far, far, far))});   // x + y − z = −far
  std::size_t count = 0;
  for_each_sample(mesh, 0, 1 << 22, kEverywhere, [&](const Int3& p) {
    EXPECT_EQ(std::int64_t{p.x} + p.y - p.z, -std::int64_t{far});
    ++count;
  });
  EXPECT_GT(count, 8000u);
}

}  // namespace
}  // namespace palpate::cpu_ref
