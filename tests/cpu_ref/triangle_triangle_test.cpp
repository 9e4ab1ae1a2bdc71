// Families of touching, overlapping and almost touching triangles whose answer is known by construction.
#include "cpu_ref/triangle_triangle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace palpate::cpu_ref {
namespace {

constexpr int kFar = kLatticeReach;  // 2^28

/// Asks in every order of corners, both ways round: the answer can't depend on it.
::testing::AssertionResult meet(const Triangle& s, const Triangle& t, bool expected) {
  std::array<int, 3> order{0, 1, 2};
  do {
    const Triangle turned(t[order[0]], t[order[1]], t[order[2]]);
    if (triangles_intersect(s, turned) != expected || triangles_intersect(turned, s) != expected)
      return ::testing::AssertionFailure() << "order " << order[0] << order[1] << order[2];
  } while (std::next_permutation(order.begin(), order.end()));
  return ::testing::AssertionSuccess();
}

const Triangle kFloor(Int3(0, 0, 0), Int3(100, 0, 0), Int3(0, 100, 0));

TEST(TrianglesIntersect, VertexOnVertexTouches) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(0, 0, 0), Int3(-5, -9, 20), Int3(-30, 4, 17)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(-1, 0, 0), Int3(-5, -9, 20), Int3(-30, 4, 17)), false));
}

TEST(TrianglesIntersect, VertexOnEdgeTouches) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(37, 0, 0), Int3(40, -9, 20), Int3(30, -4, 17)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(37, -1, 0), Int3(40, -9, 20), Int3(30, -4, 17)), false));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(50, 50, 0), Int3(90, 90, 20), Int3(80, 90, -17)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(50, 51, 0), Int3(90, 90, 20), Int3(80, 90, -17)), false));
}

TEST(TrianglesIntersect, VertexOnFaceTouches) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(20, 30, 0), Int3(25, 30, 10), Int3(20, 35, 10)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(20, 30, 1), Int3(25, 30, 10), Int3(20, 35, 10)), false));
}

TEST(TrianglesIntersect, CrossingEdgesTouchWithoutAVertex) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(50, 0, -10), Int3(50, 0, 10), Int3(60, -40, 0)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(50, -1, -10), Int3(50, -1, 10), Int3(60, -40, 0)), false));
}

TEST(TrianglesIntersect, AnEdgeThatPiercesAFaceIntersects) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(20, 20, -10), Int3(21, 22, 10), Int3(300, 300, 1)), true));
}

TEST(TrianglesIntersect, AnEdgeLyingInAFaceTouches) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(10, 10, 0), Int3(30, 20, 0), Int3(20, 20, 50)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(-10, 10, 0), Int3(130, 20, 0), Int3(20, 20, 50)), true));
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(-10, 10, 1), Int3(130, 20, 1), Int3(20, 20, 50)), false));
}

TEST(TrianglesIntersect, CoplanarTrianglesMeetAsInThePlane) {
  EXPECT_TRUE(meet(kFloor, kFloor, true));                                                       // identical
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(10, 10, 0), Int3(20, 10, 0), Int3(10, 20, 0)), true));  // inside
  EXPECT_TRUE(
      meet(kFloor, Triangle(Int3(-90, -90, 0), Int3(900, -90, 0), Int3(-90, 900, 0)), true));       // around
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(50, -50, 0), Int3(60, 200, 0), Int3(70, 200, 0)), true));  // across
  EXPECT_TRUE(
      meet(kFloor, Triangle(Int3(100, 0, 0), Int3(200, 0, 0), Int3(200, 50, 0)), true));  // corner to corner
  EXPECT_TRUE(
      meet(kFloor, Triangle(Int3(101, 0, 0), Int3(200, 0, 0), Int3(200, 50, 0)), false));  // a step apart
  EXPECT_TRUE(
      meet(kFloor, Triangle(Int3(20, 0, 0), Int3(60, 0, 0), Int3(40, -9, 0)), true));  // along an edge
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(20, -1, 0), Int3(60, -1, 0), Int3(40, -9, 0)), false));
  EXPECT_TRUE(
      meet(kFloor, Triangle(Int3(51, 50, 0), Int3(90, 90, 0), Int3(60, 90, 0)), false));  // past the slope
}

TEST(TrianglesIntersect, ParallelPlanesAStepApartDoNotMeet) {
  EXPECT_TRUE(meet(kFloor, Triangle(Int3(0, 0, 1), Int3(100, 0, 1), Int3(0, 100, 1)), false));
}

TEST(TrianglesIntersect, HoldsAtTheLatticesReach) {
  const Triangle wide(Int3(-kFar, -kFar, -kFar), Int3(kFar, -kFar, kFar), Int3(-kFar, kFar, kFar));
  EXPECT_TRUE(meet(wide, wide, true));
  // The plane of `wide` is x + y − z = −kFar. One step off it a parallel triangle does not touch.
  const auto on_plane = [](int x, int y, int off) { return Int3(x, y, x + y + kFar + off); };
  EXPECT_TRUE(meet(
      wide,
      Triangle(on_plane(-kFar / 2, -kFar / 3, 0), on_plane(-5, -kFar / 2, 0), on_plane(-kFar / 2, -7, 0)),
      true));
  EXPECT_TRUE(meet(
      wide,
      Triangle(on_plane(-kFar / 2, -kFar / 3, 1), on_plane(-5, -kFar / 2, 1), on_plane(-kFar / 2, -7, 1)),
      false));
  EXPECT_TRUE(meet(
      wide,
      Triangle(on_plane(-kFar / 2, -kFar / 3, -1), on_plane(-5, -kFar / 2, 1), on_plane(-kFar / 2, -7, 1)),
      true));
}

TEST(TrianglesIntersect, TheHypotenuseOfALatticeWideTriangleIsExact) {
  const Triangle wide(Int3(-kFar, -kFar, 0), Int3(kFar, -kFar, 0),
                      Int3(-kFar, kFar, 0));  // hypotenuse x + y = 0
  EXPECT_TRUE(
      meet(wide, Triangle(Int3(12345, -12345, -9), Int3(12345, -12345, 9), Int3(kFar, kFar, 0)), true));
  EXPECT_TRUE(
      meet(wide, Triangle(Int3(12345, -12344, -9), Int3(12345, -12344, 9), Int3(kFar, kFar, 0)), false));
}

/// Both triangles share a rational point by construction: a convex combination of corners with equal weights
/// sums to it.
TEST(TrianglesIntersect, TrianglesBuiltRoundACommonPointMeet) {
  std::mt19937 random(7);
  const auto draw = [&](int reach) { return std::uniform_int_distribution<int>(-reach, reach)(random); };
  for (int i = 0; i < 20000; ++i) {
    const int reach = i % 2 ? 8 : kFar / 8;
    const Int3 common(draw(reach), draw(reach), draw(reach));
    // Each has `common` as the middle of one corner and a point between the two others: c = (a + (b +
    // d)/2)/2.
    const auto around = [&] {
      const Int3 b(draw(reach), draw(reach), draw(reach)), a(draw(reach), draw(reach), draw(reach));
      return Triangle(a, b, 4 * common - 2 * a - b);
    };
    const Triangle s = around(), t = around();
    if (s.collapsed() || t.collapsed()) continue;
    ASSERT_TRUE(triangles_intersect(s, t)) << i;
  }
}

TEST(TrianglesIntersect, TrianglesOnTwoSidesOfAPlaneDoNotMeet) {
  std::mt19937 random(11);
  const auto draw = [&](int reach) { return std::uniform_int_distribution<int>(-reach, reach)(random); };
  for (int i = 0; i < 20000; ++i) {
    const int reach = i % 2 ? 6 : 1000;
    const Int3 n(draw(9), draw(9), draw(9));
    const auto side = [&](bool above) {
      for (;;) {
        const Int3 p(draw(reach), draw(reach), draw(reach));
        const int height = n.x * p.x + n.y * p.y + n.z * p.z;
        if (above ? height >= 1 : height <= 0) return p;
      }
    };
    if (n == Int3(0)) continue;
    const Triangle s(side(true), side(true), side(true)), t(side(false), side(false), side(false));
    if (s.collapsed() || t.collapsed()) continue;
    ASSERT_FALSE(triangles_intersect(s, t)) << i;
  }
}

TEST(SegmentMeetsTriangle, APointIsASegmentToo) {
  EXPECT_TRUE(segment_meets_triangle(Int3(10, 10, 0), Int3(10, 10, 0), kFloor));
  EXPECT_FALSE(segment_meets_triangle(Int3(10, 10, 1), Int3(10, 10, 1), kFloor));
}

}  // namespace
}  // namespace palpate::cpu_ref
