// Rays through closed meshes: the perturbed point makes every winding whole, wherever the ray passes.
#include "cpu_ref/ray.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/cpu_ref/lattice_solids.h"

namespace palpate::cpu_ref {
namespace {

int winding(const std::vector<Triangle>& mesh, const Int3& p, const Int3& direction) {
  int sum = 0;
  for (const Triangle& triangle : mesh)
    if (const auto crossing = ray_crosses(p, direction, triangle)) sum += crossing->sign;
  return sum;
}

/// p + (ε, ε², ε³) lies in a box that is closed below and open above, on every axis.
bool in_half_open_box(const Int3& p, int half) {
  for (int k = 0; k < 3; ++k)
    if (p[k] < -half || p[k] >= half) return false;
  return true;
}

TEST(RayCrosses, WindingsOfABoxAreThoseOfTheHalfOpenBoxEverywhere) {
  // Every point of a grid that holds all corners, edges, faces and diagonals of the box and of its triangles.
  const std::vector<Triangle> box = lattice_box(Int3(-2), Int3(2));
  const std::vector<Int3> directions{{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {-1, 0, 0}, {1, 1, 0},
                                     {1, -1, 1}, {2, 1, -1}, {0, -1, 2}, {1, 1, 1}};
  for (int x = -4; x <= 4; ++x)
    for (int y = -4; y <= 4; ++y)
      for (int z = -4; z <= 4; ++z)
        for (const Int3& direction : directions)
          ASSERT_EQ(winding(box, Int3(x, y, z), direction), in_half_open_box(Int3(x, y, z), 2) ? 1 : 0)
              << x << ' ' << y << ' ' << z << " along " << direction.x << direction.y << direction.z;
}

TEST(RayCrosses, AnOctahedronsWindingsAgreeInEveryDirection) {
  const std::vector<Triangle> octahedron = lattice_octahedron(4);
  const std::vector<Int3> directions{{1, 0, 0},  {0, 1, 0},   {0, 0, 1}, {1, 1, 0},
                                     {1, -1, 1}, {-2, 1, -1}, {1, 1, 1}, {-1, -1, 0}};
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y)
      for (int z = -5; z <= 5; ++z) {
        const int size = std::abs(x) + std::abs(y) + std::abs(z);
        const int first = winding(octahedron, Int3(x, y, z), directions[0]);
        if (size < 4) {
          ASSERT_EQ(first, 1);
        }
        if (size > 4) {
          ASSERT_EQ(first, 0);
        }
        for (const Int3& direction : directions)
          ASSERT_EQ(winding(octahedron, Int3(x, y, z), direction), first);
      }
}

TEST(RayCrosses, RandomPointsOfASphereAreInsideWhenTheAnalyticSphereSaysSo) {
  const int radius = 1 << 27;
  const std::vector<Triangle> sphere = lattice_sphere(radius, 24, 12);
  std::mt19937 random(17);
  std::uniform_int_distribution<int> draw(-radius, radius);
  // The mesh of 24 × 12 lies between 0.956 and 1 of the radius: cos(π/24)·cos(π/24)² bounds it from below.
  for (int i = 0; i < 3000; ++i) {
    const Int3 p(draw(random), draw(random), draw(random));
    const double r = glm::length(Vec3(p)) / radius;
    const Int3 direction(draw(random), draw(random), draw(random));
    const int w = winding(sphere, p, direction);
    if (r < 0.95) {
      ASSERT_EQ(w, 1);
    }
    if (r > 1.000001) {
      ASSERT_EQ(w, 0);
    }
    ASSERT_EQ(winding(sphere, p, Int3(1, 0, 0)), w);
  }
}

TEST(RayCrosses, AVertexSharedByManyIsPassedOnce) {
  const int radius = 1000;
  const std::vector<Triangle> sphere = lattice_sphere(radius, 24, 12);
  // From the centre through each vertex, and from below each pole through the pole.
  for (const Triangle& triangle : sphere)
    for (int k = 0; k < 3; ++k) ASSERT_EQ(winding(sphere, Int3(0), triangle[k]), 1);
  ASSERT_EQ(winding(sphere, Int3(0, 0, -2 * radius), Int3(0, 0, 1)), 0);
}

TEST(RayCrosses, SignTellsEnteringFromLeaving) {
  const Triangle up(Int3(-9, -9, 5), Int3(9, -9, 5), Int3(0, 9, 5));  // N towards +z
  const auto leaving = ray_crosses(Int3(0), Int3(0, 0, 1), up);
  ASSERT_TRUE(leaving);
  EXPECT_EQ(leaving->sign, 1);
  const auto entering = ray_crosses(Int3(0, 0, 9), Int3(0, 0, -1), up);
  ASSERT_TRUE(entering);
  EXPECT_EQ(entering->sign, -1);
  EXPECT_FALSE(ray_crosses(Int3(0, 0, 9), Int3(0, 0, 1), up));
}

TEST(RayCrosses, AStartInThePlaneIsAheadOnOneSideOnly) {
  // N = (0, 0, +): the perturbed point is above the plane, so that a ray upwards misses and one downwards
  // crosses.
  const Triangle up(Int3(-9, -9, 0), Int3(9, -9, 0), Int3(0, 9, 0));
  EXPECT_FALSE(ray_crosses(Int3(0), Int3(0, 0, 1), up));
  const auto down = ray_crosses_at(Int3(0), Int3(0, 0, -(1 << 28)), up);
  ASSERT_TRUE(down);
  EXPECT_EQ(down->height, 0u);
}

TEST(RayCrosses, HeightsAreRoundedDown) {
  const int d = 3 << 27;  // a direction of 1.5 · 2^28
  const Triangle up(Int3(-900, -900, 1000), Int3(900, -900, 1000), Int3(0, 900, 1000));
  const auto crossing = ray_crosses_at(Int3(0), Int3(0, 0, d), up);
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->height, 2666u);  // 1000 · 2^30 / d = 2666.67
}

TEST(RayCrosses, TheLongestRayOfTheLatticeFits) {
  const int far = kLatticeReach;
  const Triangle up(Int3(-far, -far, far), Int3(far, -far, far), Int3(0, far, far));
  const auto crossing = ray_crosses_at(Int3(0, 0, -far), Int3(0, 0, 1 << 28), up);
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->height, 1u << 31);
}

}  // namespace
}  // namespace palpate::cpu_ref
