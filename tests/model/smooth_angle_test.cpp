#include "model/mesh/smooth_angle.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

SmoothAngle degrees(double value) { return make_smooth_angle(value).value(); }

TEST(SmoothAngle, ExactThirtyDegreesIsNotBelowThirty) {
  // (0,1,1)·(1,1,2) = 3, squares 2 and 6: cos² = 9/12.
  EXPECT_FALSE(smooth({0, 1, 1}, {1, 1, 2}, degrees(30)));
  EXPECT_TRUE(smooth({0, 1, 1}, {1, 1, 2}, degrees(30.0001)));
}

TEST(SmoothAngle, TiesAreDecidedAtTheLargestNormals) {
  const std::int64_t big = std::int64_t{1} << 58;
  EXPECT_FALSE(smooth({0, big, big}, {big, big, 2 * big}, degrees(30)));
  // One step to either side of the tie is beyond what doubles can see.
  EXPECT_TRUE(smooth({0, big, big}, {big - 1, big, 2 * big}, degrees(30)));
  EXPECT_FALSE(smooth({0, big, big}, {big + 1, big, 2 * big}, degrees(30)));
}

TEST(SmoothAngle, RightAngleAndBeyondAreNeverSmooth) {
  EXPECT_FALSE(smooth({1, 0, 0}, {0, 1, 0}, degrees(90)));
  EXPECT_FALSE(smooth({1, 0, 0}, {-1, 1, 0}, degrees(90)));
  EXPECT_FALSE(smooth({1, 0, 0}, {-1, 0, 0}, degrees(30)));
  const std::int64_t big = std::int64_t{1} << 59;
  EXPECT_TRUE(smooth({big, 1, 0}, {0, 1, 0}, degrees(90)));  // 1 in 2^59 below a right angle
  EXPECT_FALSE(smooth({big, -1, 0}, {0, 1, 0}, degrees(90)));
}

TEST(SmoothAngle, OtherExactTies) {
  EXPECT_FALSE(smooth({1, 0, 0}, {1, 1, 0}, degrees(45)));
  EXPECT_FALSE(smooth({1, 1, 0}, {1, 0, 1}, degrees(60)));
  EXPECT_FALSE(smooth({1, 2, 3}, {2, 4, 6}, degrees(0)));  // nothing is below an angle of zero
  EXPECT_TRUE(smooth({1, 2, 3}, {2, 4, 6}, degrees(1)));
}

TEST(SmoothAngle, RefusesAnglesOutsideTheQuadrant) {
  for (const double bad : {-1.0, 90.5, std::nan(""), HUGE_VAL}) {
    const auto result = make_smooth_angle(bad);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kBadValue);
  }
}

}  // namespace
}  // namespace palpate
