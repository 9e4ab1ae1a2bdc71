// METHOD section 4, cancelled normals: the static ones of an area point all ways at once.
#include "model/generate/solids.h"
#include "tests/cpu_ref/bench_scene.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;

GeometrySettings voxels_of(double metres) {
  GeometrySettings settings;
  settings.voxel_size_m = metres;
  settings.smooth_angle_deg = 60;   // beads of few triangles are one zone
  return settings;
}

// A bead of 4 mm, one smooth zone at 60 degrees, wholly within a block: its own normals cancel, no triangle crosses another.
TEST(CancelledNormals, OfABeadInsideTheToolGiveWayToTheNearestWayOut) {
  BenchScene scene(solids::sphere_of(4 * kMm, 60), solids::box(Vec3(-20 * kMm), Vec3(20 * kMm)), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(3 * kMm, 1 * kMm, 2 * kMm));
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_TRUE(scene.contacts.cst.empty());
  EXPECT_TRUE(answer.areas[0].flags & kFlagCancelled);
  EXPECT_TRUE(answer.areas[0].flags & kFlagNearestExternal);
  EXPECT_GT(scene.contacts.areas[0].rays, 0u);
}

// The same in motion: what the frame before knew is kept instead.
TEST(CancelledNormals, OfABeadThatTheToolSwallowsKeepTheDirectionItHad) {
  BenchScene scene(solids::sphere_of(4 * kMm, 60), solids::box(Vec3(-20 * kMm), Vec3(20 * kMm)), voxels_of(2 * kMm));
  Held held;
  Vec3 before(0);
  for (double z = 23; z > 4; z -= 1) {
    scene.ask(Vec3(0.3 * kMm, 0.2 * kMm, z * kMm), &held);
    ASSERT_EQ(scene.response.areas.size(), 1u);
    if (z < 23) {
      EXPECT_LT(angle_deg(scene.response.areas[0].normal, before), 45) << z;
    }
    before = scene.response.areas[0].normal;
  }
  EXPECT_TRUE(scene.response.areas[0].flags & kFlagCancelled);
  EXPECT_TRUE(scene.response.areas[0].flags & kFlagHeld);
  EXPECT_GT(before.z, 0.9);
}

// A plate's rim within the tool: two opposite faces and the rim between, several zones; the tool's normals tell.
TEST(CancelledNormals, OfAPlatesRimAreTheTools) {
  BenchScene scene(solids::box(Vec3(-30 * kMm, -30 * kMm, -1 * kMm), Vec3(30 * kMm, 30 * kMm, 1 * kMm)),
                   solids::box(Vec3(-10 * kMm), Vec3(10 * kMm)), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(39 * kMm, 0.3 * kMm, 0.1 * kMm));
  ASSERT_EQ(answer.areas.size(), 1u);
  EXPECT_GT(scene.contacts.areas[0].zones.size(), 1u);
  EXPECT_LT(angle_deg(answer.areas[0].normal, Vec3(1, 0, 0)), 5);
}

}  // namespace
}  // namespace palpate
