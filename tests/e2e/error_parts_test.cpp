// What `bench error` and `tune` are made of: meshes cut finer, who is sooner, promises, and a report's
// pictures.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/generate/solids.h"
#include "model/scene/geometry_build.h"
#include "service/bench/error/cut_mesh.h"
#include "service/bench/error/error_findings.h"
#include "service/bench/error/numerics_cases.h"
#include "service/bench/error/plain_response.h"
#include "service/cli/promise.h"
#include "service/report/scene_picture.h"

namespace palpate {
namespace {

TEST(CutMesh, KeepsTheSurfaceClosedAndItsParts) {
  Mesh mesh;
  solids::append(mesh, solids::box(Vec3(0), Vec3(0.07, 0.011, 0.003)), "bar");
  solids::append(mesh, solids::moved(solids::sphere_of(0.01, 300), {Vec3(0.2, 0, 0), Quat(1, 0, 0, 0)}),
                 "ball");
  const Mesh finer = cut_to(mesh, 5000);
  EXPECT_LE(finer.triangles.size(), 5000u);
  EXPECT_GT(finer.triangles.size(), 2500u);
  EXPECT_EQ(solids::open_edges(finer), 0u) << "neighbours cut their edge at the same place";
  EXPECT_NEAR(solids::volume(finer), solids::volume(mesh), 1e-12 * solids::volume(mesh));
  ASSERT_EQ(finer.parts.size(), 2u);
  EXPECT_EQ(finer.parts[1].first_triangle, finer.parts[0].triangle_count);
  EXPECT_EQ(finer.parts[1].first_triangle + finer.parts[1].triangle_count, finer.triangles.size());
  for (std::uint32_t t = 0; t < finer.triangles.size(); ++t)
    EXPECT_EQ(finer.vertices[finer.triangles[t][0]].x > 0.1, t >= finer.parts[1].first_triangle) << t;
  EXPECT_EQ(cut_to(mesh, 10).triangles, mesh.triangles) << "never fewer than there are";
}

ErrorPoint point(Profile profile, double us, double error) {
  ErrorPoint out{{profile, "voxel_size", 1e-3, {}}, {}};
  for (auto& errors : out.result.errors) errors = {error};
  out.result.times_us = {us};
  return out;
}

TEST(MethodLead, IsOfTheSoonestSettingThatIsNoWorse) {
  ErrorTruths truths;
  for (auto& typical : truths.typical) typical.fill(1);
  truths.typical[1][3] = 2;  // paper's force is twice as large: the same error is half the part of it
  ErrorCurves curves{"gpu",
                     {point(Profile::kPaper, 100, 0.4), point(Profile::kPaper, 900, 0.2),
                      point(Profile::kPaper, 5000, 0.3), point(Profile::kRefined, 20, 0.5),
                      point(Profile::kRefined, 45, 0.1), point(Profile::kRefined, 300, 0.01)}};
  const auto lead = lead_of(curves, truths, 3);
  ASSERT_TRUE(lead && lead->us);
  EXPECT_DOUBLE_EQ(lead->paper_error, 0.1);
  EXPECT_DOUBLE_EQ(lead->factor(), 900.0 / 45);
  EXPECT_NE(lead_sentence(*lead).find("20 times sooner"), std::string::npos) << lead_sentence(*lead);
  EXPECT_EQ(where_wins(curves, truths, 3),
            "from 20 µs on refined alone answers, from 100 µs on refined is nearer");
  curves.points.resize(5);
  curves.points.back().result.errors[3] = {0.3};
  const auto none = lead_of(curves, truths, 3);
  ASSERT_TRUE(none && !none->us);
  EXPECT_NE(lead_sentence(*none).find("no nearer than 30 %"), std::string::npos) << lead_sentence(*none);
  EXPECT_EQ(where_wins(curves, truths, 3),
            "from 20 µs on refined alone answers, from 100 µs on paper is nearer");
  EXPECT_NE(lead_summary("By one engine, gpu", {{"a", *lead}, {"b", *none}})
                .find("sooner or more on 1 of 2: a (20 ×)."),
            std::string::npos);
  MethodLead large = *lead;
  large.paper_us = *large.us * 205;
  large.paper_error = 1.5;
  EXPECT_NE(lead_sentence(large).find("150 % off in 9.22 ms; refined is 10 % off in 45 µs, 205 times sooner"),
            std::string::npos)
      << lead_sentence(large);
}

TEST(Promise, IsBrokenWhereLuckHardlyLooksSoBad) {
  EXPECT_NEAR(chance_of_breaking(0, 40), 1, 1e-12);
  EXPECT_NEAR(chance_of_breaking(1, 1), 0.05, 1e-12);
  EXPECT_NEAR(chance_of_breaking(1, 10), 1 - std::pow(0.95, 10), 1e-12);
  EXPECT_NEAR(chance_beyond_p95(0, 30, 30), 1, 1e-9);
  // One more value lies with equal chance in each of the 21 gaps of 20 others, beyond the 19th in two of
  // them.
  EXPECT_NEAR(chance_beyond_p95(1, 1, 20), 2.0 / 21, 1e-12);
  std::vector<double> errors(60, 1.0), us(60, 10.0);
  for (std::size_t i = 0; i < 4; ++i) errors[i] = 3, us[i] = 30;
  PromiseKept kept = promise_kept("of a test", errors, us, 20, 2, 60);
  EXPECT_EQ(kept.off, 4u);
  EXPECT_EQ(kept.slow, 4u);
  EXPECT_TRUE(kept.error && kept.time) << "four of sixty are no proof against three";
  for (std::size_t i = 0; i < 14; ++i) errors[i] = 3;
  kept = promise_kept("of a test", errors, us, 20, 2, 60);
  EXPECT_FALSE(kept.error);
  EXPECT_TRUE(kept.time);
  EXPECT_NE(promise_text(kept).find("the error is not kept, the budget is"), std::string::npos);
}

TEST(NumericsCases, HaveTheForceThatAPlainSumApproaches) {
  const auto off = [](const NumericsScene& scene, double spacing) {
    const PlainAnswer answer = plain_response<double>(scene.mockup, scene.tool, scene.pose, spacing,
                                                      scene.stiffness, scene.reference_area);
    EXPECT_EQ(answer.contact, scene.contact);
    return glm::length(answer.force - scene.force) / glm::length(scene.force);
  };
  // Samples a fiftieth of a side apart see an edge to about a hundredth of it.
  EXPECT_LT(off(long_patch(4), 0.08e-3), 0.02);
  EXPECT_LT(off(many_patches(2), 0.04e-3), 0.03);
  EXPECT_LT(off(peg_with_play(0.01, true), 0.2e-3), 0.02);
  EXPECT_LT(off(tongue_pressed(0.05), 0.1e-3), 0.02);
  EXPECT_LT(off(corner_scene({}), 0.05e-3), 0.02);
  const NumericsScene free = peg_with_play(0.01, false);
  EXPECT_FALSE(plain_response<double>(free.mockup, free.tool, free.pose, free.spacing, free.stiffness,
                                      free.reference_area)
                   .contact);
  const HungBar bar = hung_bar(0.1);
  EXPECT_NEAR(bar.ratio, 0.64, 1e-12);
  EXPECT_GT(bar.scene.force.z, 0.9 * bar.ratio / (1 + bar.ratio) * bar.scene.stiffness * bar.scene.length)
      << "two springs in a row, but for the rim";
  EXPECT_LT(bar.scene.force.z, bar.ratio / (1 + bar.ratio) * bar.scene.stiffness * bar.scene.length);
}

TEST(ScenePictures, ShowTheToolBlueAndPaleBehindTheMockup) {
  const Mesh wall = solids::box(Vec3(-0.1, -0.01, -0.1), Vec3(0.1, 0, 0.1)),
             cube = solids::box(Vec3(-0.02), Vec3(0.02));
  const auto geometry = build_geometry(wall, cube, {});
  ASSERT_TRUE(geometry);
  const Quat upright(1, 0, 0, 0);
  const auto images = scene_pictures(*geometry, {{Vec3(0, -0.05, 0), upright}, {Vec3(0, 0.05, 0), upright}});
  ASSERT_EQ(images.size(), 2u);
  // The eye is on the side of −y: the first cube stands before the wall, the second behind it.
  const auto blue = [](const Image& image) {
    std::size_t strong = 0, pale = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
      const int red = image.pixels[i], more = image.pixels[i + 2] - red;
      if (red == 0 && more > 0) ++strong;
      if (red > 0 && more > 15) ++pale;
    }
    return std::pair(strong, pale);
  };
  EXPECT_GT(blue(images[0]).first, 2000u);
  EXPECT_LT(blue(images[1]).first, blue(images[0]).first / 4);
  EXPECT_GT(blue(images[1]).second, 2000u);
  const std::string address = png_address(images[0]);
  EXPECT_EQ(address.substr(0, 34), "data:image/png;base64,iVBORw0KGgoA") << "the signature of a PNG";
  EXPECT_EQ(png_address(Image{}), "");
}

}  // namespace
}  // namespace palpate
