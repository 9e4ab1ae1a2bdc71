// First contact where it is known: a pin in a bore, which is free as long as all its corners lie inside all
// the bore's planes, and a bolt's thread in a nut's, which the right screw keeps apart for ever.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "compute/native/native_backend.h"
#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "model/lattice/screw.h"
#include "model/scene/geometry_build.h"
#include "service/queries/first_contact.h"
#include "tests/equivalence/random.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// Steps: corners of both bodies are rounded to the lattice, and so is the pose.
constexpr double kRounding = 3;

struct Fit {
  Fit(const Mesh& mockup, const Mesh& tool) : geometry(std::move(*build_geometry(mockup, tool, {}))) {
    EXPECT_TRUE(native->prepare(geometry, Plan{}, [](const char*, double) { return true; }));
    rounding = kRounding * geometry.lattice.step_m;
    early = TouchRule::of(geometry, 0).early * geometry.lattice.step_m;
  }
  FirstContact first(const Pose& from, const Pose& to) {
    const auto found = first_contact(*native, geometry, from, to, TouchRule::of(geometry, 0));
    EXPECT_TRUE(found) << found.error().sentence;
    return *found;
  }
  SceneGeometry geometry;
  double rounding = 0, early = 0;  ///< m
  std::unique_ptr<CollisionBackend> native = make_native_backend();
};

Pose at(const Vec3& position, const Vec3& turn = Vec3(0)) { return {position, rotation_by(turn)}; }

constexpr std::uint32_t kSides = 64;
constexpr double kBore = 0.01, kPin = 0.0097, kHalfLength = 0.01;

/// How far a pin's nearest corner is from the nearest plane of the bore's, m; below 0: through it.
double room(const Pose& pose) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < kSides; ++k)
    for (const double z : {-kHalfLength, kHalfLength}) {
      const double angle = 2 * kPi * k / kSides;
      const Vec3 corner =
          pose.rotation * Vec3(kPin * std::cos(angle), kPin * std::sin(angle), z) + pose.position;
      for (std::uint32_t j = 0; j < kSides; ++j) {
        const double normal = 2 * kPi * (j + 0.5) / kSides;
        least = std::min(least, kBore * std::cos(kPi / kSides) - corner.x * std::cos(normal) -
                                    corner.y * std::sin(normal));
      }
    }
  return least;
}

Fit pin_in_bore() {
  return Fit(solids::moved(solids::ring(kBore, 0.013, 0.06, kSides), at(Vec3(0, 0, -0.03))),
             solids::moved(solids::cylinder(kPin, 2 * kHalfLength, kSides), at(Vec3(0, 0, -kHalfLength))));
}

TEST(ClosedMotions, APinAcrossItsBoreMeetsAFaceOrACornerWhereItsPlayEnds) {
  Fit fit = pin_in_bore();
  const auto moves = [&](double angle) {
    const FirstContact found = fit.first(at(Vec3(0)), at(0.001 * Vec3(std::cos(angle), std::sin(angle), 0)));
    EXPECT_EQ(found.kind, FirstContact::Kind::kContact);
    return 0.001 * found.time;
  };
  const double play = kBore - kPin;
  for (const std::uint32_t k : {0u, 5u, 16u, 40u}) {
    const double to_corner = moves(2 * kPi * k / kSides), to_face = moves(2 * kPi * (k + 0.5) / kSides);
    EXPECT_LE(to_corner, play + fit.rounding) << "late";
    EXPECT_GE(to_corner, play - fit.early - fit.rounding) << "early";
    EXPECT_LE(to_face, play * std::cos(kPi / kSides) + fit.rounding) << "late";
    EXPECT_GE(to_face, play * std::cos(kPi / kSides) - fit.early - fit.rounding) << "early";
  }
}

TEST(ClosedMotions, OfAPinInItsBoreAreNeverLateAndEndAtAWall) {
  Fit fit = pin_in_bore();
  equivalence::Random random(3);
  const auto some = [&] { return 2 * random.unit() - 1; };
  int contacts = 0, clear = 0;
  for (int i = 0; i < 150; ++i) {
    const Pose from = at(Vec3(0.0001 * some(), 0.0001 * some(), 0.002 * some()),
                         Vec3(0.005 * some(), 0.005 * some(), 3 * some()));
    const double far = std::pow(10, -2 * random.unit());
    const Pose to = {from.position + far * Vec3(0.001 * some(), 0.001 * some(), 0.01 * some()),
                     rotation_by(far * Vec3(0.05 * some(), 0.05 * some(), 2 * some())) * from.rotation};
    if (room(from) < fit.rounding) continue;
    const FirstContact found = fit.first(from, to);
    const Screw screw(from, to, fit.geometry);
    for (int k = 0; k <= 200; ++k)
      ASSERT_GT(room(screw.at(found.time * k / 200.0)), -fit.rounding) << "late: motion " << i;
    if (found.kind == FirstContact::Kind::kContact) {
      ASSERT_LT(room(screw.at(found.time)), fit.early + fit.rounding) << "early: motion " << i;
      ++contacts;
    } else {
      ASSERT_EQ(found.kind, FirstContact::Kind::kNone) << "motion " << i;
      ++clear;
    }
  }
  EXPECT_GT(contacts, 30);
  EXPECT_GT(clear, 30);
}

constexpr double kPitch = 0.002, kThickness = 0.0006;
constexpr std::uint32_t kStepsATurn = 90;

/// A thread: a rectangle between the first and the last of `radii`, swept along a right-handed screw from
/// −`half_turns` to `half_turns`, `offset` higher than through the origin. Where two have radii in common
/// their faces are cut into the same triangles.
Mesh thread(const std::vector<double>& radii, double half_turns, double offset) {
  Mesh out;
  const auto columns = static_cast<std::uint32_t>(radii.size());
  const auto rows = static_cast<std::int32_t>(half_turns * kStepsATurn);
  for (std::int32_t row = -rows; row <= rows; ++row)
    for (const double side : {-0.5, 0.5})
      for (const double r : radii) {
        const double angle = 2 * kPi * row / kStepsATurn;
        out.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle),
                                  kPitch * row / kStepsATurn + offset + side * kThickness);
      }
  const auto vertex = [&](std::uint32_t row, std::uint32_t side, std::uint32_t column) {
    return (2 * row + side) * columns + column;
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    out.triangles.push_back({a, b, c});
    out.triangles.push_back({a, c, d});
  };
  const std::uint32_t last = 2 * static_cast<std::uint32_t>(rows), outer = columns - 1;
  for (std::uint32_t row = 0; row < last; ++row) {
    for (std::uint32_t c = 0; c < outer; ++c) {
      // Both flanks are cut along the same diagonal.
      const auto corner = [&](std::uint32_t side, std::uint32_t r, std::uint32_t k) {
        return vertex(row + r, side, c + k);
      };
      quad(corner(1, 0, 0), corner(1, 0, 1), corner(1, 1, 1), corner(1, 1, 0));
      out.triangles.push_back({corner(0, 0, 0), corner(0, 1, 1), corner(0, 0, 1)});
      out.triangles.push_back({corner(0, 0, 0), corner(0, 1, 0), corner(0, 1, 1)});
    }
    quad(vertex(row, 0, outer), vertex(row + 1, 0, outer), vertex(row + 1, 1, outer), vertex(row, 1, outer));
    quad(vertex(row, 0, 0), vertex(row, 1, 0), vertex(row + 1, 1, 0), vertex(row + 1, 0, 0));
  }
  for (std::uint32_t c = 0; c < outer; ++c) {
    quad(vertex(0, 0, c), vertex(0, 0, c + 1), vertex(0, 1, c + 1), vertex(0, 1, c));
    quad(vertex(last, 0, c), vertex(last, 1, c), vertex(last, 1, c + 1), vertex(last, 0, c + 1));
  }
  return out;
}

class BoltInNut : public testing::Test {
 protected:
  /// The bolt turned by `angle` and raised by `height`.
  static Pose bolt(double angle, double height) { return at(Vec3(0, 0, height), Vec3(0, 0, angle)); }
  /// Until a flank is reached, of the way from the origin.
  void reaches(double angle, double height, double share, double metres) {
    const FirstContact found = fit.first(bolt(0, 0), bolt(angle, height));
    ASSERT_EQ(found.kind, FirstContact::Kind::kContact);
    EXPECT_LE((found.time - share) * metres, fit.rounding) << "late";
    EXPECT_GE((found.time - share) * metres, -fit.early - fit.rounding) << "early";
  }
  Fit fit{thread({0.005, 0.006, 0.008}, 1, 0.5 * kPitch), thread({0.004, 0.005, 0.006}, 2, 0)};
  double play = 0.5 * kPitch - kThickness;  ///< between two flanks, along the axis
};

TEST_F(BoltInNut, IsClosedOnBothSides) {
  EXPECT_TRUE(fit.geometry.mockup.closed);
  EXPECT_TRUE(fit.geometry.tool.closed);
}

TEST_F(BoltInNut, GoesOnForEverByItsOwnScrew) {
  for (int turn = -3; turn < 3;
       ++turn) {  // a third of a turn each: a screw between two poses is the shorter one
    const double from = 2 * kPi * turn / 3, to = 2 * kPi * (turn + 1) / 3;
    const FirstContact found =
        fit.first(bolt(from, from / (2 * kPi) * kPitch), bolt(to, to / (2 * kPi) * kPitch));
    EXPECT_EQ(found.kind, FirstContact::Kind::kNone) << turn << ", until " << found.time;
  }
}

TEST_F(BoltInNut, StopsWhereTheFlanksMeet) {
  // Along the axis by the play; turned without advancing by the play's share of a turn; and by a screw of
  // half the pitch after twice as much of it.
  for (const double way : {-1.0, 1.0}) {
    reaches(0, way * kPitch / 2, play / (kPitch / 2), kPitch / 2);
    const double turned = 2 * kPi * play / kPitch;
    reaches(way * 2.5, 0, turned / 2.5, 2.5 / (2 * kPi) * kPitch);
    reaches(way * 3, way * 3 / (2 * kPi) * kPitch / 2, 2 * turned / 3, 3 / (2 * kPi) * kPitch / 2);
  }
}

TEST_F(BoltInNut, StopsSoonerWhereItStandsOffCentre) {
  // Raised by half the play, half of it is left above and one and a half below.
  const double turn = 2 * kPi * play / kPitch;
  for (const double way : {-1.0, 1.0}) {
    const FirstContact found = fit.first(bolt(0, play / 2), bolt(way * 2.5, play / 2));
    ASSERT_EQ(found.kind, FirstContact::Kind::kContact);
    // A turn counterclockwise lowers a right-handed thread at each place.
    const double free = way < 0 ? 0.5 * turn : 1.5 * turn;
    const double late_m = (found.time * 2.5 - free) / (2 * kPi) * kPitch;
    EXPECT_LE(late_m, fit.rounding) << "late";
    EXPECT_GE(late_m, -fit.early - fit.rounding) << "early";
  }
}

}  // namespace
}  // namespace palpate
