#include "cpu_ref/samples.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
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
  for (const int spacing : {3, 7, 50}) {  // 3 divides the cells of 6: grid points on every edge and corner
    const auto of_two = samples_of(lattice_mesh_of(lattice_plate(min, max, 1)), spacing);
    const auto of_many = samples_of(lattice_mesh_of(lattice_plate(min, max, 100)), spacing);
    EXPECT_EQ(of_two, of_many);
    for (const auto& [point, times] : of_two) EXPECT_EQ(times, 1);
  }
}

/// The fractional part of n times the golden ratio. (The definition's 32 bits are off by n · 10^-10.)
double golden(int n) {
  const double times = n * (std::sqrt(5.0) - 1) / 2;
  return times - std::floor(times);
}

TEST(Samples, AreOneACellMovedByGoldenParts) {
  const auto samples =
      samples_of(lattice_mesh_of(lattice_plate(Int3(-200, -100, 5), Int3(200, 100, 5), 1)), 50);
  std::set<Key> expected;
  for (int i = -4; i < 4; ++i)
    for (int j = -2; j < 2; ++j)
      expected.emplace(50 * i + static_cast<int>(50 * golden(j)), 50 * j + static_cast<int>(50 * golden(i)),
                       5);
  ASSERT_EQ(samples.size(), expected.size());
  for (const auto& [point, times] : samples) EXPECT_TRUE(expected.count(point));
}

TEST(Samples, LevelsAreNestedAndHalveEachTime) {
  std::array<int, kSampleLevels + 1> count{};
  for (int i = -32; i < 32; ++i)
    for (int j = -32; j < 32; ++j)
      for (int level = level_of({i, j}); level >= 0; --level) ++count[static_cast<std::size_t>(level)];
  for (int level = 0; level <= kSampleLevels; ++level)
    EXPECT_EQ(count[static_cast<std::size_t>(level)], 64 * 64 >> level);
  // Every block of a level's own cells has one of it, or two to a pair of blocks on a chessboard.
  for (int a = 1; a <= kSampleLevels / 2; ++a)
    for (int i = -32; i < 32; i += 1 << a)
      for (int j = -32; j < 32; j += 1 << a) {
        int of_block = 0;
        for (int k = i; k < i + (1 << a); ++k)
          for (int l = j; l < j + (1 << a); ++l) of_block += level_of({k, l}) >= 2 * a ? 1 : 0;
        EXPECT_EQ(of_block, 1);
      }
}

TEST(Samples, StayWhereTheyAreWhenTheTriangleMoves) {
  // Anchored at the lattice's origin, not at the triangle.
  const Box both{Int3(-18, -19, 0), Int3(20, 20, 0)};
  const auto here =
      samples_of(lattice_mesh_of(lattice_plate(Int3(-21, -21, 0), Int3(21, 21, 0), 1)), 7, both);
  EXPECT_GT(here.size(), 20u);
  EXPECT_EQ(here, samples_of(lattice_mesh_of(lattice_plate(Int3(-18, -19, 0), Int3(24, 23, 0), 1)), 7, both));
}

TEST(Samples, ASlopedTriangleIsRoundedDown) {
  // z = x / 3: N = (−1, 0, 3) direction, axis z.
  const LatticeMesh mesh =
      lattice_mesh_of({Triangle(Int3(-90, -90, -30), Int3(90, -90, 30), Int3(-90, 90, -30))});
  for (const auto& [point, times] : samples_of(mesh, 7)) {
    const auto [x, y, z] = point;
    EXPECT_EQ(z, static_cast<int>(std::floor(x / 3.0)));
  }
}

TEST(Samples, TurningATriangleRoundKeepsItsSamples) {
  std::mt19937 random(31);
  std::uniform_int_distribution<int> draw(-200, 200);
  for (int i = 0; i < 200; ++i) {
    const Triangle t(Int3(draw(random), draw(random), draw(random)),
                     Int3(draw(random), draw(random), draw(random)),
                     Int3(draw(random), draw(random), draw(random)));
    if (t.collapsed()) continue;
    EXPECT_EQ(samples_of(lattice_mesh_of({t}), 9),
              samples_of(lattice_mesh_of({Triangle(t[0], t[2], t[1])}), 9));
  }
}

TEST(Samples, AClosedMeshHasEachProjectedPointAsOftenUpAsDown) {
  // Of the faces sampled along one axis alone, edges shared by two of them must count once: on a closed
  // surface whose faces all have that axis no point is lost, and none is double.
  const LatticeMesh mesh = lattice_mesh_of(lattice_octahedron(120));  // ties: every face takes axis x
  std::map<std::pair<int, int>, int> above;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    ASSERT_EQ(mesh.sample_axis[t], 0);
    for_each_sample(mesh, t, 10, kEverywhere, [&](const Int3& p) {
      above[{p.y, p.z}] += triangle_of(mesh, t).normal.x > 0 ? 1 : -1000;
    });
  }
  for (const auto& [place, count] : above) EXPECT_EQ(count, 1 - 1000);
  EXPECT_NEAR(static_cast<double>(above.size()), 288,
              34);  // cells of 10² in the square |y| + |z| < 120; its border crosses 68, and each may have
                    // its sample on either side
}

TEST(Samples, ClippingLeavesOutWhatIsOutsideAlone) {
  std::mt19937 random(37);
  std::uniform_int_distribution<int> draw(-200, 200);
  const Box clip{Int3(-50, -70, -60), Int3(90, 40, 80)};
  for (int i = 0; i < 100; ++i) {
    const LatticeMesh mesh = lattice_mesh_of({Triangle(Int3(draw(random), draw(random), draw(random)),
                                                       Int3(draw(random), draw(random), draw(random)),
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
  const LatticeMesh mesh = lattice_mesh_of(
      {Triangle(Int3(-far, -far, -far), Int3(far, -far, far), Int3(-far, far, far))});  // x + y − z = −far
  std::size_t count = 0;
  for_each_sample(mesh, 0, 1 << 22, kEverywhere, [&](const Int3& p) {
    EXPECT_EQ(std::int64_t{p.x} + p.y - p.z, -std::int64_t{far});
    ++count;
  });
  EXPECT_GT(count, 8000u);
}

}  // namespace
}  // namespace palpate::cpu_ref
