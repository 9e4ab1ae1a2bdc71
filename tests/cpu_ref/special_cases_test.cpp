// METHOD section 4's special cases, each as it says.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cpu_ref/samples.h"
#include "model/generate/solids.h"
#include "tests/cpu_ref/bench_scene.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;
const Vec3 kUp(0, 0, 1);

Mesh block(int cells = 1) {
  return solids::box(Vec3(-60 * kMm, -60 * kMm, -80 * kMm), Vec3(60 * kMm, 60 * kMm, 0),
                     Int3(cells, cells, 1));
}

GeometrySettings voxels_of(double metres) {
  GeometrySettings settings;
  settings.voxel_size_m = metres;
  return settings;
}

TEST(Swallowed, PaperIsSilent) {
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 500), voxels_of(2 * kMm), Profile::kPaper);
  const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 2 * kMm, -20 * kMm));
  EXPECT_TRUE(answer.contact);
  EXPECT_EQ(glm::length(answer.wrench.force), 0);
}

TEST(FlippedShell, PushesTheSameWay) {
  const Mesh ball = solids::sphere_of(10 * kMm, 2000);
  BenchScene scene(block(), ball, voxels_of(2 * kMm)),
      flipped_block(solids::turned_inside_out(block()), ball, voxels_of(2 * kMm));
  BenchScene flipped_ball(block(), solids::turned_inside_out(ball), voxels_of(2 * kMm));
  const Vec3 at(1 * kMm, 2 * kMm, 8 * kMm);
  const ContactResponse expected = scene.ask(at);
  ASSERT_EQ(expected.areas.size(), 1u);
  for (BenchScene* other : {&flipped_block, &flipped_ball}) {
    const ContactResponse& answer = other->ask(at);
    EXPECT_EQ(answer.wrench.force, expected.wrench.force);
    EXPECT_EQ(answer.wrench.torque, expected.wrench.torque);
  }
}

TEST(EqualMeshes, AToolEqualToTheMockUpIsAnsweredExactly) {
  const Mesh shape = solids::torus(20 * kMm, 6 * kMm, 32, 16);
  BenchScene scene(shape, shape, voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(0));
  const auto count = static_cast<std::uint32_t>(shape.triangles.size());
  EXPECT_EQ(scene.contacts.cst.size(), count);  // each triangle lies on its double
  EXPECT_EQ(scene.contacts.cmt.size(), count);
  EXPECT_TRUE(scene.contacts.bst.empty());
  EXPECT_TRUE(scene.contacts.imt.empty());
  // On a closed mesh every triangle meets at least itself and its three neighbours.
  EXPECT_GE(scene.contacts.pairs, std::uint64_t{4} * count);
  EXPECT_TRUE(std::isfinite(glm::length(answer.wrench.force)));
}

TEST(Heights, InPaperAreOfTheAreasOwnToolTrianglesAlone) {
  // A clamp round a rod, 1 mm into its top and 2 mm into its bottom; the arm below is the wider one. Rays
  // from the top that pass the narrow arm would go on to the arm below, 58 mm away, which touches the rod as
  // well but belongs to the other area.
  const Mesh rod =
      solids::box(Vec3(-20 * kMm, -20 * kMm, -60 * kMm), Vec3(20 * kMm, 20 * kMm, 0), Int3(20, 20, 1));
  Mesh clamp;
  solids::append(clamp, solids::box(Vec3(-4 * kMm, -4 * kMm, -1 * kMm), Vec3(4 * kMm, 4 * kMm, 10 * kMm)),
                 "upper arm");
  solids::append(clamp,
                 solids::box(Vec3(-12 * kMm, -12 * kMm, -70 * kMm), Vec3(12 * kMm, 12 * kMm, -58 * kMm)),
                 "lower arm");
  BenchScene scene(rod, clamp, voxels_of(4 * kMm), Profile::kPaper);
  const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 1 * kMm, 0));
  ASSERT_EQ(answer.areas.size(), 2u);
  for (const AreaResponse& area : answer.areas) {
    const bool top = area.normal.z > 0;
    EXPECT_LT(angle_deg(area.normal, top ? kUp : -kUp), 1e-6);
    EXPECT_NEAR(area.depth, (top ? 1 : 2) * kMm, 1e-6);  // m: lattice steps and Q30
  }
  EXPECT_NE(answer.areas[0].normal.z > 0, answer.areas[1].normal.z > 0);
  EXPECT_NEAR(answer.wrench.force.z, -BenchScene::kStiffness * 1 * kMm, 1e-2);  // N
}

TEST(Est, FineTrianglesInTheMiddleKeepTheContactWhole) {
  // Cells of 0.6 and 0.4 mm under samples 0.5 mm apart: many triangles have none. Were they left out, the
  // middle of the contact would fall apart into islands, each with a force of its own.
  const Mesh ball = solids::sphere_of(10 * kMm, 8000);
  BenchScene coarse(block(1), ball, voxels_of(2 * kMm));
  const Vec3 at(1 * kMm, 2 * kMm, 6 * kMm);
  const double expected = coarse.ask(at).wrench.force.z;
  for (const int cells : {200, 300}) {
    BenchScene fine(block(cells), ball, voxels_of(2 * kMm));
    EXPECT_EQ(fine.ask(at).areas.size(), 1u);
    EXPECT_NEAR(fine.response.wrench.force.z, expected,
                1e-3 * expected);  // N: the same samples, faces snapped to the lattice
  }
}

TEST(Est, HasTheTrianglesWithASampleInTheToolAndNoOther) {
  const double r = 10 * kMm;
  BenchScene scene(block(100), solids::sphere_of(r, 20000), voxels_of(2 * kMm));
  // Turned, so that the tool's own grid is askew to the world's.
  const Vec3 centre(1 * kMm, 2 * kMm, 3 * kMm);
  scene.ask(Pose{centre, glm::normalize(Quat(0.9, 0.2, -0.3, 0.1))});
  const SceneGeometry& geometry = *scene.geometry;
  const Lattice& lattice = geometry.lattice;
  int inside = 0;
  for (std::uint32_t s = 0; s < geometry.mockup.triangles.size(); ++s) {
    // The mesh of 20,000 lies between 0.999 and 1 of the radius.
    double nearest = 1e9;
    cpu_ref::for_each_sample(
        geometry.mockup, s, geometry.sample_spacing, {Int3(-kLatticeReach), Int3(kLatticeReach)},
        [&](const Int3& p) {
          nearest = std::min(nearest, glm::length(lattice.origin_m + lattice.step_m * Vec3(p) - centre));
        });
    const bool found = std::binary_search(scene.contacts.est.begin(), scene.contacts.est.end(), s);
    const bool crossed = std::binary_search(scene.contacts.cst.begin(), scene.contacts.cst.end(), s);
    if (nearest > r) {
      EXPECT_FALSE(found) << s;
    }
    if (nearest < 0.999 * r) {
      EXPECT_TRUE(found || crossed) << s;
    }
    inside += found;
  }
  EXPECT_GT(inside, 100);
}

TEST(Refined, AsksTheSameTwiceGetsTheSame) {
  BenchScene scene(block(8), solids::sphere_of(10 * kMm, 2000), voxels_of(2 * kMm));
  const Vec3 at(1 * kMm, 2 * kMm, 8 * kMm);
  scene.ask(at);
  const Contacts first = scene.contacts;
  scene.ask(Vec3(0, 0, 30 * kMm));
  scene.ask(at);
  EXPECT_EQ(scene.contacts.cst, first.cst);
  EXPECT_EQ(scene.contacts.bmt, first.bmt);
  ASSERT_EQ(scene.contacts.areas.size(), first.areas.size());
  EXPECT_EQ(scene.contacts.areas[0].height_sum, first.areas[0].height_sum);
  EXPECT_EQ(scene.contacts.areas[0].rays, first.areas[0].rays);
}

}  // namespace
}  // namespace palpate
