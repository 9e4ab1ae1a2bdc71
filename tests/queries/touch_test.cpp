// Whether a tool of many triangles touches walls close all round it, where much has to be asked before
// anything meets: against the sets of whole frames, which share no search with it.
#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

#include "compute/native/native_backend.h"
#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "model/scene/geometry_build.h"
#include "tests/equivalence/random.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3, kHalf = 10 * kMm, kPlay = 0.1 * kMm, kLong = 60 * kMm;

/// Four boards round a square hole along z, of half a side kHalf: 48 triangles.
Mesh boards() {
  const double out = 2 * kHalf, z = kLong;
  Mesh mesh = solids::box(Vec3(kHalf, -out, -z), Vec3(out, out, z));
  solids::append(mesh, solids::box(Vec3(-out, -out, -z), Vec3(-kHalf, out, z)), "left");
  solids::append(mesh, solids::box(Vec3(-kHalf, kHalf, -z), Vec3(kHalf, out, z)), "far");
  solids::append(mesh, solids::box(Vec3(-kHalf, -out, -z), Vec3(kHalf, -kHalf, z)), "near");
  return mesh;
}

TEST(Touch, OfAFineShaftInASquareHoleIsWhatFramesSay) {
  const auto geometry = build_geometry(boards(), solids::cylinder(kHalf - kPlay, kLong, 96, 100), {});
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  ASSERT_GT(geometry->tool.triangles.size(), 15'000u);
  const auto native = make_native_backend();
  ASSERT_TRUE(native->prepare(*geometry, Plan{}, {}));
  equivalence::Random random(11);
  const auto some = [&] { return 2 * random.unit() - 1; };
  int touching = 0;
  for (int i = 0; i < 200; ++i) {
    // Within its play, and tilted by about as much as makes its ends meet.
    const Pose pose{kPlay * Vec3(some(), some(), 20 * some()),
                    rotation_by(2 * kPlay / kLong * Vec3(some(), some(), some()))};
    const LatticePose at = *to_lattice(pose, *geometry);
    std::uint8_t bit = 0;
    ASSERT_TRUE(native->touches({&at, 1}, {&bit, 1}));
    Contacts contacts;
    ASSERT_TRUE(native->query(at, nullptr, contacts));
    ASSERT_EQ(bit != 0, contacts.contact) << "pose " << i;
    touching += bit;
  }
  EXPECT_GT(touching, 40);
  EXPECT_LT(touching, 160);
}

/// A box with a hollow, and a small cube in the middle of that.
Mesh hollow() {
  Mesh mesh = solids::box(Vec3(-30 * kMm), Vec3(30 * kMm));
  Mesh inner = solids::box(Vec3(-20 * kMm), Vec3(20 * kMm));
  for (auto& triangle : inner.triangles) std::swap(triangle[1], triangle[2]);
  solids::append(mesh, inner, "hollow");
  solids::append(mesh, solids::box(Vec3(-1 * kMm), Vec3(1 * kMm)), "cube");
  return mesh;
}

TEST(Touch, OfWhatLiesWhollyInsideIsNoDistance) {
  struct Place {
    double x, y, distance;  ///< of the tool's middle; 0: it touches. mm
  };
  const std::vector<Place> of_a_small_tool{
      {25, 0, 0},   // in the wall
      {10, 0, 7},   // to the cube
      {15, 0, 3},   // to the wall
      {45, 0, 13},  // outside
  };
  const std::vector<Place> of_a_large_tool{
      {0, 0, 0},                          // the cube is in it
      {45, 0, 5},                         // outside, before a face
      {45, 45, 5 * std::numbers::sqrt2},  // and before an edge
  };
  for (const auto& [half, places] : {std::pair{2, of_a_small_tool}, {10, of_a_large_tool}}) {
    GeometrySettings settings;
    settings.voxel_size_m = 2 * kMm;
    const auto geometry =
        build_geometry(hollow(), solids::box(Vec3(-half * kMm), Vec3(half * kMm)), settings);
    ASSERT_TRUE(geometry) << geometry.error().sentence;
    const auto native = make_native_backend();
    ASSERT_TRUE(native->prepare(*geometry, Plan{}, {}));
    for (const Place& place : places) {
      SCOPED_TRACE(place.x);
      const LatticePose at =
          *to_lattice({Vec3(place.x * kMm, place.y * kMm, 0), Quat(1, 0, 0, 0)}, *geometry);
      std::uint8_t bit = 0;
      ASSERT_TRUE(native->touches({&at, 1}, {&bit, 1}));
      EXPECT_EQ(bit != 0, place.distance == 0);
      Clearance found;
      ASSERT_TRUE(native->clearance(at, INT32_MAX - 2, found));
      ASSERT_EQ(found.kind, place.distance == 0 ? Clearance::Kind::kTouching : Clearance::Kind::kApart);
      if (place.distance == 0) continue;
      // Two corners are rounded to the lattice, and what is left to whole steps.
      EXPECT_NEAR(found.steps, place.distance * kMm / geometry->lattice.step_m, 3);
      const std::int32_t steps = found.steps;
      ASSERT_TRUE(native->clearance(at, steps, found));
      EXPECT_EQ(found.kind, Clearance::Kind::kApart);
      ASSERT_TRUE(native->clearance(at, steps - 1, found));
      EXPECT_EQ(found.kind, Clearance::Kind::kFurther);
    }
  }
}

/// Beyond the lattice nothing touches; what still has a place on it is measured all the same.
TEST(Touch, OfWhatIsBeyondTheLatticeIsADistanceAsFarAsThereAreNumbers) {
  const auto geometry = build_geometry(solids::box(Vec3(-30 * kMm), Vec3(30 * kMm)),
                                       solids::box(Vec3(-10 * kMm), Vec3(10 * kMm)), {});
  ASSERT_TRUE(geometry) << geometry.error().sentence;
  const auto native = make_native_backend();
  ASSERT_TRUE(native->prepare(*geometry, Plan{}, {}));
  int measured = 0, further = 0;
  for (int x = 45; x < 1000; x += 5) {
    const LatticePose at = *to_lattice({Vec3(x * kMm, 0, 0), Quat(1, 0, 0, 0)}, *geometry);
    Clearance found;
    ASSERT_TRUE(native->clearance(at, INT32_MAX - 2, found));
    if (found.kind == Clearance::Kind::kFurther) {
      EXPECT_TRUE(at.beyond_lattice);
      ++further;
      continue;
    }
    ASSERT_EQ(found.kind, Clearance::Kind::kApart) << x;
    EXPECT_NEAR(found.steps, (x - 40) * kMm / geometry->lattice.step_m, 3) << x;
    measured += at.beyond_lattice ? 1 : 0;
  }
  EXPECT_GT(measured, 0);
  EXPECT_GT(further, 0);
}

}  // namespace
}  // namespace palpate
