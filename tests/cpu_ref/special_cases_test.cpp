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

Mesh block(int cells = 1) { return solids::box(Vec3(-60 * kMm, -60 * kMm, -80 * kMm), Vec3(60 * kMm, 60 * kMm, 0), Int3(cells, cells, 1)); }

GeometrySettings voxels_of(double metres) {
  GeometrySettings settings;
  settings.voxel_size_m = metres;
  return settings;
}

TEST(Swallowed, AToolInsideIsPushedToTheNearestWayOut) {
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 500), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 2 * kMm, -20 * kMm));
  EXPECT_TRUE(answer.contact);
  EXPECT_TRUE(scene.contacts.cst.empty());
  EXPECT_FALSE(scene.contacts.imt.empty());
  EXPECT_TRUE(answer.flags & kFlagSwallowed);
  EXPECT_TRUE(answer.flags & kFlagNearestExternal);
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_LT(angle_deg(answer.areas[0].normal, kUp), 8);   // to the centre of a voxel above, not straight up
  // Its lowest point is 25 mm deep: within two voxels.
  EXPECT_NEAR(answer.areas[0].depth, 25 * kMm, 4 * kMm);
  EXPECT_GT(answer.wrench.force.z, 0);
}

TEST(Swallowed, TheDirectionItHadIsKept) {
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 500), voxels_of(2 * kMm));
  Held held;
  double before = 0;
  // Pushed in from above and on past the middle: the nearest way out would be the bottom in the end.
  for (double z = 6; z > -60; z -= 1) {
    const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 2 * kMm, z * kMm), &held);
    EXPECT_GE(answer.wrench.force.z, 0) << z;
    EXPECT_LT(std::fabs(answer.wrench.force.z - before), BenchScene::kStiffness * 8 * kMm) << z;   // N: a step, and two voxels of 2 mm
    before = answer.wrench.force.z;
  }
  EXPECT_TRUE(scene.response.flags & kFlagSwallowed);
  EXPECT_TRUE(scene.response.flags & kFlagHeld);
  EXPECT_LT(angle_deg(scene.response.areas[0].normal, kUp), 0.01);
}

TEST(Swallowed, JustUnderTheSurfaceCountsAsWell) {
  // Wholly inside by a fraction of a voxel: the face above is listed as near, and must not silence the way out.
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 500), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 2 * kMm, -5.5 * kMm));
  EXPECT_TRUE(scene.contacts.cst.empty());
  EXPECT_FALSE(scene.contacts.bst.empty());
  EXPECT_TRUE(answer.flags & kFlagSwallowed);
  EXPECT_GT(answer.wrench.force.z, BenchScene::kStiffness * 5 * kMm);
}

TEST(Swallowed, PaperIsSilent) {
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 500), voxels_of(2 * kMm), Profile::kPaper);
  const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 2 * kMm, -20 * kMm));
  EXPECT_TRUE(answer.contact);
  EXPECT_EQ(glm::length(answer.wrench.force), 0);
}

TEST(Needle, BetweenTheSamplesIsStillFelt) {
  // A cone of 0.2 mm at the base of its 20 mm, tip down, 3 mm in: no sample at a spacing of 0.5 mm can be inside.
  const Mesh cone = solids::revolve({{0.001 * kMm, 0}, {0.1 * kMm, 20 * kMm}}, 12, solids::Ends::kPoints);
  BenchScene scene(block(), cone, voxels_of(2 * kMm));
  for (const double deep : {1.0, 3.0, 6.0}) {
    const ContactResponse& answer = scene.ask(Vec3(0.25 * kMm, 0.25 * kMm, -deep * kMm));
    ASSERT_EQ(answer.areas.size(), 1u);
    EXPECT_TRUE(answer.areas[0].flags & kFlagNeedle);
    EXPECT_LT(angle_deg(answer.areas[0].normal, kUp), 0.001);
    EXPECT_GT(answer.areas[0].depth, 0.3 * deep * kMm);
    EXPECT_LT(answer.areas[0].depth, 1.05 * deep * kMm);
  }
}

TEST(FlippedShell, PushesTheSameWay) {
  const Mesh ball = solids::sphere_of(10 * kMm, 2000);
  BenchScene scene(block(), ball, voxels_of(2 * kMm)), flipped_block(solids::turned_inside_out(block()), ball, voxels_of(2 * kMm));
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

/// A square without thickness, facing up or down.
Mesh sheet(bool up) {
  Mesh mesh;
  const double a = 60 * kMm;
  mesh.vertices = {Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  if (!up) mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  mesh.parts = {{"sheet", 0, 2}};
  return mesh;
}

TEST(OpenSheet, PushesTowardsTheToolsCentreWhicheverWayItWasMade) {
  for (const bool up : {true, false}) {
    BenchScene scene(sheet(up), solids::sphere_of(10 * kMm, 2000), voxels_of(2 * kMm));
    for (const double side : {1.0, -1.0}) {
      const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 2 * kMm, side * 8 * kMm));
      ASSERT_EQ(answer.areas.size(), 1u);
      EXPECT_TRUE(answer.areas[0].flags & kFlagSheet);
      EXPECT_LT(angle_deg(answer.areas[0].normal, side * kUp), 1e-6);
      // The cap's mean height: h = 2 mm on a sphere of 10 mm, V/A = 1.037 mm.
      // A tenth of the spacing of samples, which is a quarter of the contact's radius.
      EXPECT_NEAR(answer.areas[0].depth, 1.037 * kMm, 0.05 * kMm);
    }
  }
}

TEST(OpenSheet, KeepsItsSideWhileTheContactLasts) {
  BenchScene scene(sheet(true), solids::sphere_of(10 * kMm, 2000), voxels_of(2 * kMm));
  Held held;
  for (double z = 12; z > -9; z -= 0.5) EXPECT_GE(scene.ask(Vec3(0, 0, z * kMm), &held).wrench.force.z, 0) << z;
  EXPECT_TRUE(scene.response.flags & kFlagHeld);
  EXPECT_LT(scene.ask(Vec3(0, 0, -8.5 * kMm)).wrench.force.z, 0);   // a lone query takes the side of gc
}

TEST(TJunction, DoesNotDoubleTheForce) {
  // A plate whose left half is cut finer than its right half: seams all along the middle.
  const double a = 60 * kMm;
  Mesh fine = solids::box(Vec3(-a, -a, -50 * kMm), Vec3(a, a, 0), Int3(2, 1, 1)), seamed = fine;
  const auto split = [&](Mesh& mesh) {
    // Every top triangle of the left half is cut at the middle of its edge on x = 0, which the right half does not know.
    const std::size_t count = mesh.triangles.size();
    for (std::size_t t = 0; t < count; ++t) {
      auto tri = mesh.triangles[t];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = mesh.vertices[tri[k]], q = mesh.vertices[tri[(k + 1) % 3]], r = mesh.vertices[tri[(k + 2) % 3]];
        if (p.x != 0 || q.x != 0 || p.z != 0 || q.z != 0 || r.z != 0 || r.x > 0) continue;
        const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(0.5 * (p + q));
        mesh.triangles[t] = {tri[k], middle, tri[(k + 2) % 3]};
        mesh.triangles.push_back({middle, tri[(k + 1) % 3], tri[(k + 2) % 3]});
        return;
      }
    }
    FAIL() << "no triangle to split";
  };
  split(seamed);
  seamed.parts = {{"", 0, static_cast<std::uint32_t>(seamed.triangles.size())}};
  const Mesh ball = solids::sphere_of(10 * kMm, 2000);
  BenchScene whole(fine, ball, voxels_of(2 * kMm)), cut(seamed, ball, voxels_of(2 * kMm)), paper(seamed, ball, voxels_of(2 * kMm), Profile::kPaper);
  ASSERT_EQ(cut.geometry->mockup.triangles.size(), whole.geometry->mockup.triangles.size() + 1);
  const Vec3 at(0.3 * kMm, 1 * kMm, 8 * kMm);
  const ContactResponse expected = whole.ask(at);
  EXPECT_EQ(cut.ask(at).areas.size(), 1u);
  EXPECT_NEAR(cut.response.wrench.force.z, expected.wrench.force.z, 1e-3 * expected.wrench.force.z);
  EXPECT_EQ(paper.ask(at).areas.size(), 2u);
}

TEST(EqualMeshes, AToolEqualToTheMockUpIsAnsweredExactly) {
  const Mesh shape = solids::torus(20 * kMm, 6 * kMm, 32, 16);
  BenchScene scene(shape, shape, voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(0));
  const auto count = static_cast<std::uint32_t>(shape.triangles.size());
  EXPECT_EQ(scene.contacts.cst.size(), count);   // each triangle lies on its double
  EXPECT_EQ(scene.contacts.cmt.size(), count);
  EXPECT_TRUE(scene.contacts.bst.empty());
  EXPECT_TRUE(scene.contacts.imt.empty());
  // On a closed mesh every triangle meets at least itself and its three neighbours.
  EXPECT_GE(scene.contacts.pairs, std::uint64_t{4} * count);
  EXPECT_TRUE(std::isfinite(glm::length(answer.wrench.force)));
}

TEST(OpenTool, HasTheNearestHitsAndSaysSo) {
  // A hemisphere without a lid.
  Mesh bowl = solids::sphere_of(10 * kMm, 2000);
  std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.vertices[t[0]].z + bowl.vertices[t[1]].z + bowl.vertices[t[2]].z > 0; });
  bowl.parts = {{"bowl", 0, static_cast<std::uint32_t>(bowl.triangles.size())}};
  BenchScene scene(block(), bowl, voxels_of(2 * kMm));
  const double centre = scene.geometry->tool_centre_m.z;
  EXPECT_LT(centre, 0);
  const ContactResponse& free = scene.ask(Vec3(0, 0, 12 * kMm));
  EXPECT_FALSE(free.contact);
  EXPECT_TRUE(free.flags & kFlagToolOpen);
  const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 2 * kMm, 9 * kMm));
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_TRUE(answer.areas[0].flags & kFlagToolOpen);
  EXPECT_TRUE(scene.contacts.est.empty());
  EXPECT_LT(angle_deg(answer.areas[0].normal, kUp), 1e-6);
  // The cap is 1 mm deep: its mean height is 0.51 mm.
  EXPECT_NEAR(answer.areas[0].depth, 0.51 * kMm, 0.05 * kMm);
}

/// Plates one below the other as one tool; z from … to of each, in mm.
Mesh plates(std::initializer_list<std::pair<double, double>> heights) {
  Mesh mesh;
  for (const auto& [low, high] : heights)
    solids::append(mesh, solids::box(Vec3(-10 * kMm, -10 * kMm, low * kMm), Vec3(10 * kMm, 10 * kMm, high * kMm)), "plate");
  return mesh;
}

TEST(Heights, EndWhereTheRayFirstLeavesTheTool) {
  // The upper plate reaches 1 mm into the block; another, 3 mm further down, is no part of that contact.
  BenchScene scene(block(), plates({{-5, -4}, {-1, 2}}), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 2 * kMm, 0));
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_NEAR(answer.areas[0].depth, 1 * kMm, 1e-6);   // m: lattice steps and Q30
}

TEST(Heights, GoThroughPartsThatOverlap) {
  // Two parts that overlap are one body 4 mm deep: the inner faces at 1 and 2 mm end nothing.
  BenchScene scene(block(), plates({{-4, -1}, {-2, 2}}), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 2 * kMm, 0));
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_NEAR(answer.areas[0].depth, 4 * kMm, 1e-6);
}

TEST(Heights, InPaperAreOfTheAreasOwnToolTrianglesAlone) {
  // A clamp round a rod, 1 mm into its top and 2 mm into its bottom; the arm below is the wider one. Rays from the top that pass the narrow arm
  // would go on to the arm below, 58 mm away, which touches the rod as well but belongs to the other area.
  const Mesh rod = solids::box(Vec3(-20 * kMm, -20 * kMm, -60 * kMm), Vec3(20 * kMm, 20 * kMm, 0), Int3(20, 20, 1));
  Mesh clamp;
  solids::append(clamp, solids::box(Vec3(-4 * kMm, -4 * kMm, -1 * kMm), Vec3(4 * kMm, 4 * kMm, 10 * kMm)), "upper arm");
  solids::append(clamp, solids::box(Vec3(-12 * kMm, -12 * kMm, -70 * kMm), Vec3(12 * kMm, 12 * kMm, -58 * kMm)), "lower arm");
  BenchScene scene(rod, clamp, voxels_of(4 * kMm), Profile::kPaper);
  const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 1 * kMm, 0));
  ASSERT_EQ(answer.areas.size(), 2u);
  for (const AreaResponse& area : answer.areas) {
    const bool top = area.normal.z > 0;
    EXPECT_LT(angle_deg(area.normal, top ? kUp : -kUp), 1e-6);
    EXPECT_NEAR(area.depth, (top ? 1 : 2) * kMm, 1e-6);   // m: lattice steps and Q30
  }
  EXPECT_NE(answer.areas[0].normal.z > 0, answer.areas[1].normal.z > 0);
  EXPECT_NEAR(answer.wrench.force.z, -BenchScene::kStiffness * 1 * kMm, 1e-2);   // N
}

TEST(Est, FineTrianglesInTheMiddleKeepTheContactWhole) {
  // Cells of 0.6 and 0.4 mm under samples 0.5 mm apart: many triangles have none. Were they left out, the middle of the
  // contact would fall apart into islands, each with a force of its own.
  const Mesh ball = solids::sphere_of(10 * kMm, 8000);
  BenchScene coarse(block(1), ball, voxels_of(2 * kMm));
  const Vec3 at(1 * kMm, 2 * kMm, 6 * kMm);
  const double expected = coarse.ask(at).wrench.force.z;
  for (const int cells : {200, 300}) {
    BenchScene fine(block(cells), ball, voxels_of(2 * kMm));
    EXPECT_EQ(fine.ask(at).areas.size(), 1u);
    EXPECT_NEAR(fine.response.wrench.force.z, expected, 1e-3 * expected);   // N: the same samples, faces snapped to the lattice
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
    cpu_ref::for_each_sample(geometry.mockup, s, geometry.sample_spacing, {Int3(-kLatticeReach), Int3(kLatticeReach)}, [&](const Int3& p) {
      nearest = std::min(nearest, glm::length(lattice.origin_m + lattice.step_m * Vec3(p) - centre));
    });
    const bool found = std::binary_search(scene.contacts.est.begin(), scene.contacts.est.end(), s);
    const bool crossed = std::binary_search(scene.contacts.cst.begin(), scene.contacts.cst.end(), s);
    if (nearest > r) { EXPECT_FALSE(found) << s; }
    if (nearest < 0.999 * r) { EXPECT_TRUE(found || crossed) << s; }
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
