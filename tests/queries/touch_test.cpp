// Whether a tool of many triangles touches walls close all round it, where much has to be asked before
// anything meets: against the sets of whole frames, which share no search with it.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace palpate
