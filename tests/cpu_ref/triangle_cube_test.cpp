#include "cpu_ref/triangle_cube.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

#include "cpu_ref/touched_voxels.h"

namespace palpate::cpu_ref {
namespace {

const Box kCube{Int3(0), Int3(8)};

TEST(TriangleMeetsBox, AVertexOnAFaceTouches) {
  EXPECT_TRUE(triangle_meets_box(Triangle(Int3(8, 3, 4), Int3(20, 3, 4), Int3(20, 9, 4)), kCube));
  EXPECT_FALSE(triangle_meets_box(Triangle(Int3(9, 3, 4), Int3(20, 3, 4), Int3(20, 9, 4)), kCube));
}

TEST(TriangleMeetsBox, AVertexOnACornerTouches) {
  EXPECT_TRUE(triangle_meets_box(Triangle(Int3(8, 8, 8), Int3(20, 30, 40), Int3(20, 9, 40)), kCube));
}

TEST(TriangleMeetsBox, AnEdgeThroughACornerTouches) {
  // From (16, 0, 8) to (0, 16, 8) by way of (8, 8, 8).
  EXPECT_TRUE(triangle_meets_box(Triangle(Int3(16, 0, 8), Int3(0, 16, 8), Int3(30, 30, 30)), kCube));
  EXPECT_FALSE(triangle_meets_box(Triangle(Int3(17, 0, 8), Int3(0, 17, 8), Int3(30, 30, 30)), kCube));
}

TEST(TriangleMeetsBox, AFaceThroughACornerAloneTouches) {
  // The plane x + y + z = 24 has only (8, 8, 8) in common with the cube.
  EXPECT_TRUE(
      triangle_meets_box(Triangle(Int3(104, -40, -40), Int3(-40, 104, -40), Int3(-40, -40, 104)), kCube));
  EXPECT_FALSE(
      triangle_meets_box(Triangle(Int3(105, -40, -40), Int3(-40, 105, -40), Int3(-40, -40, 105)), kCube));
}

TEST(TriangleMeetsBox, AWideFaceThroughTheMiddleTouchesThoughNoEdgeDoes) {
  EXPECT_TRUE(triangle_meets_box(Triangle(Int3(-900, -900, 3), Int3(900, -900, 5), Int3(0, 900, 4)), kCube));
  EXPECT_FALSE(triangle_meets_box(Triangle(Int3(-900, -900, 9), Int3(900, -900, 9), Int3(0, 900, 9)), kCube));
}

TEST(TriangleMeetsBox, ATriangleInsideTouches) {
  EXPECT_TRUE(triangle_meets_box(Triangle(Int3(3, 3, 3), Int3(4, 3, 3), Int3(3, 4, 3)), kCube));
}

TEST(TriangleMeetsBox, AnOverlapOfBoxesAloneIsNoTouch) {
  EXPECT_FALSE(triangle_meets_box(Triangle(Int3(17, 0, 4), Int3(0, 17, 4), Int3(17, 17, 4)), kCube));
}

TEST(TriangleMeetsBox, HoldsAtTheLatticesReach) {
  const int far = kLatticeReach;
  const Triangle wide(Int3(-far, -far, -far), Int3(far, -far, far),
                      Int3(-far, far, far));  // x + y − z = −far
  const auto cube_at = [](const Int3& p) { return Box{p, p + Int3(8)}; };
  const int x = -far / 3, y = -far / 5, z = x + y + far;
  EXPECT_TRUE(triangle_meets_box(wide, cube_at(Int3(x, y, z))));
  EXPECT_TRUE(
      triangle_meets_box(wide, cube_at(Int3(x - 8, y - 8, z))));  // its far corner in x and y is on the plane
  EXPECT_FALSE(triangle_meets_box(wide, cube_at(Int3(x - 9, y - 8, z))));  // and now a step short of it
}

/// Clips a polygon in floating point: a second way, good when the answer is not close.
bool meets_clearly(const Triangle& triangle, const Box& box, double margin) {
  std::vector<Vec3> polygon{Vec3(triangle[0]), Vec3(triangle[1]), Vec3(triangle[2])};
  for (int k = 0; k < 3; ++k)
    for (const int sign : {-1, 1}) {
      const double limit = sign > 0 ? box.max[k] + margin : -(box.min[k] - margin);
      std::vector<Vec3> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = sign * a[k] - limit, db = sign * b[k] - limit;
        if (da <= 0) kept.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
      }
      polygon = kept;
    }
  return !polygon.empty();
}

TEST(TriangleMeetsBox, AgreesWithClippingWhereverThatIsClear) {
  std::mt19937 random(3);
  const auto draw = [&](int reach) { return std::uniform_int_distribution<int>(-reach, reach)(random); };
  int met = 0, missed = 0;
  for (int i = 0; i < 100000; ++i) {
    const int reach = i % 3 == 0 ? 20 : i % 3 == 1 ? 60 : 400;
    const Triangle triangle(Int3(draw(reach), draw(reach), draw(reach)),
                            Int3(draw(reach), draw(reach), draw(reach)),
                            Int3(draw(reach), draw(reach), draw(reach)));
    if (triangle.collapsed()) continue;
    const bool answer = triangle_meets_box(triangle, kCube);
    // 1e-6: far above rounding of 1e-13.
    if (meets_clearly(triangle, kCube, -1e-6)) {
      ASSERT_TRUE(answer) << i;
    }
    if (!meets_clearly(triangle, kCube, 1e-6)) {
      ASSERT_FALSE(answer) << i;
    }
    ++(answer ? met : missed);
  }
  EXPECT_GT(met, 5000);
  EXPECT_GT(missed, 5000);
}

TEST(TouchedVoxels, HalvingFindsWhatAskingEveryVoxelFinds) {
  VoxelGrid grid;
  grid.origin = Int3(-96);
  grid.size = 8;
  grid.bricks = Int3(3);
  std::mt19937 random(5);
  const auto draw = [&] { return std::uniform_int_distribution<int>(-120, 120)(random); };
  for (const int grow : {0, 3})
    for (int i = 0; i < 40; ++i) {
      const Triangle triangle(Int3(draw(), draw(), draw()), Int3(draw(), draw(), draw()),
                              Int3(draw(), draw(), draw()));
      if (triangle.collapsed()) continue;
      std::set<std::tuple<int, int, int>> found, expected;
      for_each_touched_voxel(
          triangle, grid, grow, [](const Int3&, const Int3&) { return true; },
          [&](const Int3& v) { ASSERT_TRUE(found.emplace(v.x, v.y, v.z).second) << "found twice"; });
      for (int z = 0; z < 24; ++z)
        for (int y = 0; y < 24; ++y)
          for (int x = 0; x < 24; ++x)
            if (triangle_meets_box(triangle, voxel_box(grid, Int3(x, y, z), Int3(x, y, z) + Int3(1), grow)))
              expected.emplace(x, y, z);
      ASSERT_EQ(found, expected);
    }
}

}  // namespace
}  // namespace palpate::cpu_ref
