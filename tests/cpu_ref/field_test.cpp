// The pressure field against closed forms, symmetry and itself: docs/EXACTNESS.md section 8.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "model/contact/field_response.h"
#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "tests/cpu_ref/bench_scene.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kMm = 1e-3;

Mesh block() { return solids::box(Vec3(-60, -60, -60) * kMm, Vec3(60, 60, 0) * kMm, Int3(1)); }

GeometrySettings voxels_of(double metres) {
  GeometrySettings settings;
  settings.voxel_size_m = metres;
  return settings;
}

double modulus(const BenchScene& scene) { return field_modulus(*scene.geometry, BenchScene::kStiffness); }

/// A block with a square hole through it, the hole's sides `half` from its axis z.
Mesh square_hole(double half) {
  const double a = 40 * kMm, h = 15 * kMm;
  Mesh mesh;
  for (const double z : {-h, h})
    for (const double r : {half, a})
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        mesh.vertices.emplace_back(r * x, r * y, z);
  const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
    mesh.triangles.push_back({p, q, r});
    mesh.triangles.push_back({p, r, s});
  };
  for (std::uint32_t i = 0; i < 4; ++i) {  // 0…3 inner and 4…7 outer corners below, 8…15 above
    const std::uint32_t j = (i + 1) % 4;
    quad(i, j, 8 + j, 8 + i);  // the hole's wall, seen from its axis … turned below
    quad(4 + i, 4 + j, 12 + j, 12 + i);
    quad(8 + i, 8 + j, 12 + j, 12 + i);
    quad(4 + i, 4 + j, j, i);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (t % 8 < 2 || t % 8 == 4 || t % 8 == 5 || t % 8 >= 6)
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  mesh.parts = {{"hole", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

TEST(Field, OfAFlatContactIsModulusTimesAreaTimesDepth) {
  BenchScene scene(block(), solids::box(Vec3(-10, -8, -5) * kMm, Vec3(10, 8, 5) * kMm, Int3(1)),
                   voxels_of(2 * kMm));
  for (const double d : {0.01, 0.1, 0.4}) {
    const ContactResponse& answer = scene.ask(Vec3(0.123, 0.321, 5 - d) * kMm);
    const double expected = modulus(scene) * 20 * kMm * 16 * kMm * d * kMm;
    // Samples are 0.5 mm apart, so a side has one more or less of 32; within d of a side the side is nearer
    // than the bottom.
    EXPECT_NEAR(answer.wrench.force.z / expected, 1, 0.06) << d;
    EXPECT_LT(angle_deg(answer.wrench.force, Vec3(0, 0, 1)), 0.5) << d;
  }
}

TEST(Field, OfASphereInAPlaneIsTheIntegralOverTheCap) {
  const double r = 10 * kMm;
  BenchScene scene(block(), solids::sphere_of(r, 20000), voxels_of(1 * kMm));
  for (const double h : {0.5 * kMm, 1 * kMm, 3 * kMm}) {
    // Depth below the sphere over the disc, and below the plane over the cap seen from above; half of each.
    const double a2 = 2 * r * h - h * h;
    const double in_sphere = kPi * (r * a2 - 2.0 / 3 * (r * r * r - std::pow(r - h, 3))),
                 in_plane = kPi * h * h * (3 * r - h) / 3;
    const ContactResponse& answer = scene.ask(Vec3(1.7 * kMm, -2.3 * kMm, r - h));
    EXPECT_NEAR(answer.wrench.force.z / (modulus(scene) * 0.5 * (in_sphere + in_plane)), 1, 0.03)
        << h;  // some 60 to 1,000 samples a body
    EXPECT_LT(angle_deg(answer.wrench.force, Vec3(0, 0, 1)), 1) << h;
  }
}

TEST(Field, OfANeedleIsThatOfItsTip) {
  BenchScene scene(block(), solids::box(Vec3(-0.3, -0.3, -20) * kMm, Vec3(0.3, 0.3, 20) * kMm, Int3(1)),
                   voxels_of(2 * kMm));
  // Of the block's samples, 0.5 mm apart, one or two lie in it, no deeper than 0.3 mm.
  for (const double d : {0.2, 1.0, 3.0})
    for (const double x : {0.0, 0.11, 0.23}) {
      const ContactResponse& answer = scene.ask(Vec3(1.3 + x, 0.7, 20 - d) * kMm);
      const double expected = modulus(scene) * 0.6 * kMm * 0.6 * kMm * d * kMm;
      EXPECT_NEAR(answer.wrench.force.z / expected, 1, 1e-3) << d;  // corners on the lattice
    }
}

TEST(Field, OfASquarePegCentredInATightHoleCancels) {
  BenchScene scene(square_hole(10 * kMm),
                   solids::box(Vec3(-10.1, -10.1, -30) * kMm, Vec3(10.1, 10.1, 30) * kMm, Int3(1)),
                   voxels_of(2 * kMm));
  ASSERT_TRUE(scene.geometry->mockup.closed);
  const double unit =
      modulus(scene) * 4 * 20 * kMm * 30 * kMm * 0.1 * kMm;  // what its walls push with, all together
  const ContactResponse centred = scene.ask(Vec3(0));
  EXPECT_TRUE(centred.contact);
  EXPECT_LT(glm::length(centred.wrench.force), 0.01 * unit);
  const Vec3 off = scene.ask(Vec3(0.05, 0, 0) * kMm).wrench.force;
  EXPECT_LT(angle_deg(off, Vec3(-1, 0, 0)), 3);
  const ContactResponse turned = scene.ask(Pose{Vec3(0), rotation_by(Vec3(0, 0, 5e-3))});
  EXPECT_LT(glm::length(turned.wrench.force), 0.02 * unit);
  EXPECT_LT(turned.wrench.torque.z, 0) << "turned back";
  const ContactResponse tilted = scene.ask(Pose{Vec3(0), rotation_by(Vec3(0, 5e-3, 0))});
  EXPECT_LT(glm::length(tilted.wrench.force), 0.02 * unit);
  EXPECT_LT(tilted.wrench.torque.y, 0) << "righted";
}

TEST(Field, IsTheGradientOfAnEnergy) {
  // Round a small loop over a block's edge, the work of force comes to nothing.
  BenchScene scene(block(), solids::sphere_of(8 * kMm, 4000), voxels_of(1 * kMm));
  const Vec3 middle = Vec3(61, 0.3, 4) * kMm;
  constexpr int kSteps = 60;
  double work = 0, size = 0;
  Vec3 force_before(0), place_before(0);
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = 2 * kPi * i / kSteps;
    const Vec3 place = middle + 2 * kMm * Vec3(std::cos(angle), 0, std::sin(angle));
    const Vec3 force = scene.ask(place).wrench.force;
    if (i > 0) {
      const double part = glm::dot(0.5 * (force + force_before), place - place_before);
      work += part;
      size += std::fabs(part);
    }
    force_before = force;
    place_before = place;
  }
  EXPECT_GT(size, 0);
  EXPECT_LT(std::fabs(work), 0.03 * size);  // the limit for closed loops
}

TEST(Field, PushesAThinNeedleAlongItsAxis) {
  // Its tip of 0.6 mm is thinner than samples are apart: extra samples stand for it.
  BenchScene scene(block(), solids::box(Vec3(-0.3, -0.3, -20) * kMm, Vec3(0.3, 0.3, 20) * kMm, Int3(1)),
                   voxels_of(4 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(3.1, 2.2, 20 - 2) * kMm);
  EXPECT_TRUE(answer.contact);
  EXPECT_GT(answer.wrench.force.z, 0);
  EXPECT_LT(angle_deg(answer.wrench.force, Vec3(0, 0, 1)), 20);
}

TEST(Field, PushesASheetOutTheWayItCameIn) {
  Mesh sheet;
  const double a = 60 * kMm;
  sheet.vertices = {Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  sheet.parts = {{"sheet", 0, 2}};
  BenchScene scene(sheet, solids::sphere_of(10 * kMm, 4000), voxels_of(2 * kMm));
  for (const double side : {1.0, -1.0}) {
    const ContactResponse& answer = scene.ask(Vec3(1 * kMm, 2 * kMm, side * 8.5 * kMm));
    EXPECT_TRUE((answer.flags & kFlagSheet) != 0);
    EXPECT_LT(angle_deg(answer.wrench.force, Vec3(0, 0, side)), 3);
  }
}

/// A block's surface with a square hole in its top, z = 0: what it has inside ends there, at no triangle.
Mesh leaky_block(double half_hole) {
  const double a = 20 * kMm;
  Mesh mesh;
  for (const auto& [r, z] : {std::pair{half_hole, 0.0}, {a, 0.0}, {a, -2 * a}})
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      mesh.vertices.emplace_back(r * x, r * y, z);
  const auto quad = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) {
    mesh.triangles.push_back({p, q, r});
    mesh.triangles.push_back({p, r, s});
  };
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    quad(4 + i, 4 + j, j, i);          // about the hole
    quad(8 + i, 8 + j, 4 + j, 4 + i);  // a side
  }
  quad(8, 11, 10, 9);
  mesh.parts = {{"leaky", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

TEST(Field, OfAToolThatLeavesALeakyBodyHasNoStep) {
  // A strip goes through the hole and touches nothing. Each of its samples leaves by itself, not the whole
  // of it with a first corner.
  Mesh strip;
  strip.vertices = {Vec3(-0.5, 0, 5) * kMm, Vec3(-0.5, 0, -5) * kMm, Vec3(0.5, 0, -5) * kMm,
                    Vec3(0.5, 0, 5) * kMm};
  strip.triangles = {{0, 1, 2}, {0, 2, 3}};
  strip.parts = {{"strip", 0, 2}};
  BenchScene scene(leaky_block(1 * kMm), strip, voxels_of(2 * kMm));
  ASSERT_FALSE(scene.geometry->mockup.closed);
  double largest = 0, step = 0;
  std::optional<Vec3> before;
  for (int i = -55; i <= 55; ++i) {
    const Vec3 force = scene.ask(Vec3(0.1, 0.2, 0.1 * i) * kMm).wrench.force;
    EXPECT_TRUE(scene.contacts.cst.empty());
    largest = std::max(largest, glm::length(force));
    if (before) step = std::max(step, glm::length(force - *before));
    before = force;
  }
  EXPECT_EQ(*before, Vec3(0)) << "it is out";
  EXPECT_GT(largest, 1);
  EXPECT_LT(step, 0.05 * largest);  // one of 20 rows of samples
}

TEST(Field, OfASwallowedToolPointsTheNearestWayOut) {
  BenchScene scene(block(), solids::sphere_of(5 * kMm, 2000), voxels_of(2 * kMm));
  const ContactResponse& answer = scene.ask(Vec3(3, 2, -12) * kMm);
  EXPECT_TRUE(answer.contact);
  EXPECT_TRUE(scene.contacts.cst.empty());
  EXPECT_LT(angle_deg(answer.wrench.force, Vec3(0, 0, 1)), 3);
}

TEST(Field, LeavesIgnoredPatchesOutAndNamesThem) {
  BenchScene scene(block(), solids::box(Vec3(-5, -5, -5) * kMm, Vec3(5, 5, 5) * kMm, Int3(1)),
                   voxels_of(2 * kMm));
  const ContactResponse felt = scene.ask(Vec3(0, 0, 4.5) * kMm);
  ASSERT_GT(felt.wrench.force.z, 0);
  Ignored all;
  all.patches.resize(scene.geometry->mockup.patch_count);
  std::iota(all.patches.begin(), all.patches.end(), 0u);
  const auto pose = to_lattice(Pose{Vec3(0, 0, 4.5) * kMm, Quat(1, 0, 0, 0)}, *scene.geometry);
  ASSERT_TRUE(pose);
  Contacts contacts;
  ASSERT_TRUE(scene.backend->query(*pose, &all, contacts));
  EXPECT_TRUE(contacts.contact) << "sets are what they are";
  EXPECT_EQ(contacts.field.max_depth, 0u);
  EXPECT_EQ(contacts.ignored_touched.size(), 1u) << "the block's top alone";
}

}  // namespace
}  // namespace palpate
