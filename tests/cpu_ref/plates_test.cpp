// Large triangles, deep contacts and thin plates.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "model/generate/solids.h"
#include "tests/cpu_ref/bench_scene.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;

double sphere_depth(double r, double h) { return h * h * (3 * r - h) / 3 / (2 * r * h - h * h); }

/// A plate whose top face is cut into 2·cells² triangles; thick, so that nothing comes out below.
Mesh plate(int cells) { return solids::box(Vec3(-100 * kMm, -100 * kMm, -40 * kMm), Vec3(100 * kMm, 100 * kMm, 0), Int3(cells, cells, 1)); }

/// d of a sphere of 15 voxels' radius over the truth, at a depth in voxels.
double share_found(BenchScene& scene, double radius, double voxels_deep) {
  const double h = voxels_deep * scene.voxel();
  const ContactResponse& answer = scene.ask(Vec3(1.3 * kMm, 2.1 * kMm, radius - h));
  return answer.areas.size() == 1 ? answer.areas[0].depth / sphere_depth(radius, h) : 0;
}

TEST(Plates, RefinedKeepsTheDepthAtEveryDepthOnTwoAndOn20000Triangles) {
  GeometrySettings settings;
  settings.voxel_size_m = 2 * kMm;
  const Mesh tool = solids::sphere_of(30 * kMm, 20000);
  BenchScene few(plate(1), tool, settings), many(plate(100), tool, settings);
  BenchScene paper_few(plate(1), tool, settings, Profile::kPaper), paper_many(plate(100), tool, settings, Profile::kPaper);
  for (const double deep : {0.5, 1.0, 2.0, 5.0}) {
    const double f = share_found(few, 30 * kMm, deep), m = share_found(many, 30 * kMm, deep);
    const double pf = share_found(paper_few, 30 * kMm, deep), pm = share_found(paper_many, 30 * kMm, deep);
    std::printf("%.1f voxels deep: d / truth refined %.4f (2) %.4f (20,000), paper %.4f (2) %.4f (20,000)\n", deep, f, m, pf, pm);
    EXPECT_NEAR(f, 1, 0.02);
    EXPECT_NEAR(m, 1, 0.02);
    EXPECT_EQ(pf, 0);            // no centroid is near: the tool falls through
    if (deep >= 2) { EXPECT_LT(pm, 0.75); }   // the centre of the contact is lost
  }
}

TEST(Plates, ASpherePushedRightThroughAPlateIsNeverPulled) {
  const double r = 25 * kMm, thickness = 1 * kMm;
  // Steps of half a millimetre, and of 4 µm where the sphere's lowest and highest points pass the faces: there the contact
  // with one of them is smaller than any spacing of samples.
  std::vector<double> depths;
  for (double h = -0.5 * kMm; h < 52 * kMm; h += 0.5 * kMm) depths.push_back(h);
  for (const double h : {0.0, thickness, 2 * r, 2 * r + thickness})
    for (int i = -6; i <= 6; ++i) depths.push_back(h + i * 4e-6);
  std::sort(depths.begin(), depths.end());
  for (const int cells : {1, 32}) {
    BenchScene scene(solids::box(Vec3(-80 * kMm, -80 * kMm, -thickness), Vec3(80 * kMm, 80 * kMm, 0), Int3(cells, cells, 1)),
                     solids::sphere_of(r, 3000));
    Held held;
    double before = 0, worst = 0, least = 0, most = 0;
    for (const double h : depths) {
      const double force = scene.ask(Vec3(1 * kMm, 0.7 * kMm, r - h), &held).wrench.force.z;
      least = std::min(least, force);
      most = std::max(most, force);
      worst = std::max(worst, std::fabs(force - before));
      before = force;
    }
    std::printf("plate of %zu triangles: force %.2f … %.2f N, largest step %.2f N\n", scene.geometry->mockup.triangles.size(), least, most, worst);
    EXPECT_GE(least, 0);                                   // N: it came from above, it is pushed back up
    EXPECT_LE(worst, BenchScene::kStiffness * thickness);  // N
    EXPECT_GT(most, 20);                                   // N: two thirds of the radius at the middle are felt
    EXPECT_EQ(before, 0);                                  // it is out
  }
}

TEST(Plates, ComingBackFromTheMiddleIsTheSameForce) {
  const double r = 25 * kMm;
  BenchScene scene(solids::box(Vec3(-80 * kMm, -80 * kMm, -1 * kMm), Vec3(80 * kMm, 80 * kMm, 0)), solids::sphere_of(r, 3000));
  Held held;
  std::vector<double> down, up;
  for (int i = 0; i <= 30; ++i) down.push_back(scene.ask(Vec3(0, 0, r - i * kMm), &held).wrench.force.z);
  for (int i = 30; i >= 0; --i) up.insert(up.begin(), scene.ask(Vec3(0, 0, r - i * kMm), &held).wrench.force.z);
  EXPECT_EQ(down, up);   // conservative: no energy for the hand
}

TEST(Plates, ALoneQueryTakesTheNearerSide) {
  const double r = 25 * kMm;
  BenchScene scene(solids::box(Vec3(-80 * kMm, -80 * kMm, -1 * kMm), Vec3(80 * kMm, 80 * kMm, 0)), solids::sphere_of(r, 3000));
  const ContactResponse above = scene.ask(Vec3(0, 0, 10 * kMm));
  ASSERT_EQ(above.areas.size(), 2u);
  EXPECT_GT(above.wrench.force.z, 0);
  EXPECT_TRUE(above.areas[0].flags & kFlagPierced);
  EXPECT_TRUE(above.areas[1].flags & kFlagPierced);
  EXPECT_NE(above.areas[0].silent, above.areas[1].silent);
  EXPECT_LT(scene.ask(Vec3(0, 0, -11 * kMm)).wrench.force.z, 0);
}

TEST(Plates, TwoParallelPlatesPushBoth) {
  // The tool is through the upper plate and into the lower: they are not one piercing.
  const double r = 25 * kMm;
  Mesh plates = solids::box(Vec3(-80 * kMm, -80 * kMm, -1 * kMm), Vec3(80 * kMm, 80 * kMm, 0));
  solids::append(plates, solids::box(Vec3(-80 * kMm, -80 * kMm, -9 * kMm), Vec3(80 * kMm, 80 * kMm, -8 * kMm)), "lower");
  BenchScene scene(plates, solids::sphere_of(r, 3000));
  const ContactResponse& answer = scene.ask(Vec3(0, 0, r - 12 * kMm));
  int pushing = 0;
  for (const AreaResponse& area : answer.areas) {
    if (area.force.z > 0) ++pushing;
    EXPECT_GE(area.force.z, 0);
  }
  EXPECT_EQ(answer.areas.size(), 4u);
  EXPECT_EQ(pushing, 2);
}

TEST(Plates, ANeedleThroughAPlateIsPushedBackByOneSide) {
  // Much thinner than the spacing of samples: both faces have crossings and no sample inside.
  Mesh needle = solids::cylinder(0.05 * kMm, 60 * kMm, 6);
  GeometrySettings settings;
  settings.voxel_size_m = 2 * kMm;
  settings.centre_of_mass_m = Vec3(0, 0, 30 * kMm);
  BenchScene scene(solids::box(Vec3(-80 * kMm, -80 * kMm, -1 * kMm), Vec3(80 * kMm, 80 * kMm, 0)), needle, settings);
  // Between the grid points of the samples, 5 mm beyond the front.
  const Vec3 between(0.26 * kMm, 0.24 * kMm, -5 * kMm);
  const ContactResponse& answer = scene.ask(between);
  ASSERT_EQ(answer.areas.size(), 2u);
  EXPECT_TRUE(answer.areas[0].flags & kFlagNeedle);
  EXPECT_TRUE(answer.areas[1].flags & kFlagNeedle);
  EXPECT_GT(answer.wrench.force.z, 0);
  EXPECT_LT(answer.wrench.force.z, BenchScene::kStiffness * 5.1 * kMm);
}

}  // namespace
}  // namespace palpate
