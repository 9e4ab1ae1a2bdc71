// From a contact response to planes.
#include "service/loop/law_result.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "driver/limits.h"
#include "tests/service/force_law_fixture.h"

namespace palpate {
namespace {

AreaResponse area(std::uint32_t id, const Vec3& normal, double depth, double max_depth, const Vec3& point) {
  return {.id = id,
          .normal = normal,
          .depth = depth,
          .max_depth = max_depth,
          .point = point,
          .force = kK * depth * normal,
          .torque = glm::cross(point, kK * depth * normal),
          .flags = 0};
}

TEST(LawResult, TakesTheStiffnessFromTheSlopeOfTheDepthWithinAQuarterAndOne) {
  ContactResponse response;
  response.contact = true;
  const double slopes[] = {0.5, 0.1, 1, 1.3, -0.2};
  for (std::uint32_t i = 0; i < 5; ++i) {
    response.areas.push_back(area(i, Vec3(0, 0, 1), 2e-3, 4e-3, Vec3(0)));
    response.areas.back().slope = slopes[i];
  }
  LawResult out;
  fill_law_result(response, false, kK, out);
  ASSERT_EQ(out.plane_count, 5u);
  const double expected[] = {1000, 500, 2000, 2000, 500};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(out.planes[i].stiffness, expected[i], 1e-9) << i;
}

/// `paper`: the slope of one area whose mean height is `mean` times its largest.
double paper_slope(double mean) {
  Contacts contacts;
  contacts.contact = true;
  ContactArea area;
  area.direction = Int3(0, 0, 1 << 28);
  area.rays = 1;
  area.max_height = 1u << 30;
  area.height_sum = std::llround(mean * (1 << 30));
  contacts.areas = {area};
  ContactResponse response;
  respond(contacts, LatticePose{}, SceneGeometry{}, Profile::kPaper, kK, response);
  return response.areas[0].slope;
}

TEST(Respond, EstimatesTheSlopeOfPapersDepthOnTheSafeSideAndWithinOneAndAHalfPercent) {
  EXPECT_NEAR(paper_slope(1), 1, 1e-8) << "flat";
  EXPECT_NEAR(paper_slope(1. / 3), 1. / 3, 1e-8) << "a corner";
  // Mean height of a cap: d = h (3R − h) / (3 (2R − h)); ∂d/∂h by x = h/R: (6 − 4x + x²) / (3 (2 − x)²).
  for (double x = 0.01; x <= 0.5; x += 0.01) {
    const double ratio =
        paper_slope((3 - x) / (3 * (2 - x))) / ((6 - 4 * x + x * x) / (3 * (2 - x) * (2 - x)));
    EXPECT_GE(ratio, 1 - 1e-8) << x;  // below is what costs stability; rounding
    EXPECT_LE(ratio, 1.015) << x;
  }
}

TEST(LawResult, LeavesOutAreasThatDoNotPush) {
  ContactResponse response;
  response.areas = {area(1, Vec3(0, 0, 1), 1e-3, 1e-3, Vec3(0)), area(2, Vec3(0, 0, -1), 5e-3, 5e-3, Vec3(0)),
                    area(3, Vec3(0), 0, 0, Vec3(0))};
  response.areas[1].force = Vec3(0);  // nothing of it is deep
  LawResult out;
  fill_law_result(response, false, kK, out);
  EXPECT_EQ(out.plane_count, 1u);
  EXPECT_EQ(out.areas, 1u);
}

TEST(LawResult, MergesTheSmallestOfManyAreasIntoOnePlaneWithTheSameWrench) {
  ContactResponse response;
  response.gc = Vec3(0.5, 0, 0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.1, 1);
  Wrench sum;
  for (std::uint32_t i = 0; i < 100; ++i) {
    AreaResponse a = area(i, glm::normalize(Vec3(unit(random), unit(random), 1)), 1e-3 * unit(random), 2e-3,
                          Vec3(unit(random), 0, 0));
    a.torque = glm::cross(a.point - response.gc, a.force);
    sum.force += a.force, sum.torque += a.torque;
    response.areas.push_back(a);
  }
  response.wrench = sum;
  LawResult out;
  fill_law_result(response, false, kK, out);
  EXPECT_EQ(out.areas, 100u);
  ASSERT_EQ(out.plane_count, kMaxLawPlanes);
  out.tick = 0, out.gc = response.gc;
  ForceLawState state(law(kC, 1));
  const Wrench force = state.step({1, response.gc, out.rotation}, &out);
  EXPECT_LT(length(force.force - sum.force), 1e-9);
  EXPECT_LT(length(force.torque - sum.torque), 1e-9);
  for (std::uint32_t p = 1; p + 1 < kMaxLawPlanes; ++p)
    EXPECT_LE(out.planes[p].force, out.planes[p - 1].force);
}

}  // namespace
}  // namespace palpate
