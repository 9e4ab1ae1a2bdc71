// First contact against closed forms and dense sampling (docs/EXACTNESS.md, section 10): never late, early by
// no more than promised.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "compute/native/native_backend.h"
#include "compute/scene/exact.h"
#include "cpu_ref/ref_backend.h"
#include "model/generate/solids.h"
#include "model/lattice/rotation.h"
#include "model/lattice/screw.h"
#include "model/scene/geometry_build.h"
#include "service/queries/first_contact.h"
#include "tests/equivalence/lattice_shapes.h"
#include "tests/equivalence/random.h"

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Asked {
  Asked(const Mesh& mockup, const Mesh& tool) : geometry(std::move(*build_geometry(mockup, tool, {}))) {
    EXPECT_TRUE(native->prepare(geometry, Plan{}, [](const char*, double) { return true; }));
  }
  FirstContact first(const Pose& from, const Pose& to) {
    const auto found = first_contact(*native, geometry, from, to, TouchRule::of(geometry, 0));
    EXPECT_TRUE(found) << found.error().sentence;
    return *found;
  }
  bool touches(const Pose& pose) {
    std::uint8_t bit = 0;
    const LatticePose at = *to_lattice(pose, geometry);
    EXPECT_TRUE(native->touches({&at, 1}, {&bit, 1}));
    return bit != 0;
  }
  SceneGeometry geometry;
  std::unique_ptr<CollisionBackend> native = make_native_backend();
};

Pose pose_at(const Vec3& position, const Quat& rotation = Quat(1, 0, 0, 0)) { return {position, rotation}; }

TEST(Screw, EndsWhereItIsToldAndMovesAsItSays) {
  const Asked asked(solids::box(Vec3(-0.1), Vec3(0.1)),
                    solids::box(Vec3(0.01, 0.02, 0.03), Vec3(0.05, 0.04, 0.09)));
  equivalence::Random random(7);
  for (int i = 0; i < 200; ++i) {
    const auto some = [&] { return 2 * random.unit() - 1; };
    const double turn = i % 4 == 0 ? 1e-9 : i % 4 == 1 ? 0 : 2;
    const Pose from = pose_at(Vec3(some(), some(), some()), rotation_by(Vec3(some(), some(), some()))),
               to = pose_at(Vec3(some(), some(), some()),
                            rotation_by(turn * Vec3(some(), some(), some())) * from.rotation);
    const Screw screw(from, to, asked.geometry);
    const Vec3 p(0.3, -0.2, 0.1);
    const auto point = [&](const Pose& pose) { return pose.rotation * p + pose.position; };
    EXPECT_LT(glm::length(point(screw.at(0)) - point(from)), 1e-12);
    EXPECT_LT(glm::length(point(screw.at(1)) - point(to)), 1e-12);
    // The velocity against a difference of places, and the same speed everywhere.
    const double t = random.unit(), dt = 1e-5, step = asked.geometry.lattice.step_m;
    const Twist twist = screw.twist(t);
    const Vec3 origin = screw.at(t).rotation * asked.geometry.tool_centre_m + screw.at(t).position;
    const Vec3 told =
        twist.velocity * step + twist.angle * glm::cross(twist.axis, point(screw.at(t)) - origin);
    const Vec3 seen = (point(screw.at(t + dt)) - point(screw.at(t - dt))) / (2 * dt);
    EXPECT_LT(glm::length(told - seen), 1e-8) << i;
    EXPECT_NEAR(glm::length(twist.velocity), glm::length(screw.twist(0).velocity),
                1e-6 * glm::length(twist.velocity) + 1e-9);
  }
}

TEST(FirstContact, OfASphereOnAPlaneIsWhereItsLowestCornerIs) {
  Asked asked(solids::box(Vec3(-0.2, -0.2, -0.05), Vec3(0.2, 0.2, 0)), solids::sphere(0.02));
  double lowest = 0;
  for (const Int3& v : asked.geometry.tool.vertices)
    lowest = std::min(lowest, v.z * asked.geometry.lattice.step_m);
  const double early = TouchRule::of(asked.geometry, 0).early * asked.geometry.lattice.step_m;
  for (const double start : {0.03, 0.1, 0.5, 2.0}) {  // from within the grid, and from beyond the lattice
    const FirstContact found =
        asked.first(pose_at(Vec3(0.003, 0.001, start)), pose_at(Vec3(0.003, 0.001, -0.01)));
    ASSERT_EQ(found.kind, FirstContact::Kind::kContact);
    const double height = start + found.time * (-0.01 - start), touching = -lowest;
    EXPECT_GE(height, touching) << "late";
    EXPECT_LE(height - touching, early) << "too early";
    EXPECT_LE(found.evaluations, 12u);
  }
}

/// A sliver half a step high, at a pose where its rounded corners are collinear and it is in no pair: on a
/// screw it counts nevertheless, for it is there.
TEST(FirstContact, OfASliverThatIsCollinearAtItsPosesIsNotLate) {
  const Int3 a(0, 0, 0), b(25, 0, 0), c(50, 1, 0);
  const auto scene =
      equivalence::lattice_scene(equivalence::box_of(Int3(-512), Int3(512)), {{a, b, c}, {a, c, b}}, 64, 32);
  ASSERT_TRUE(scene) << scene.error().sentence;
  const auto native = make_native_backend(), ref = make_ref_backend();
  int collinear = 0;
  for (CollisionBackend* backend : {native.get(), ref.get()}) {
    ASSERT_TRUE(backend->prepare(*scene, Plan{}, {}));
    for (int i = 0; i < 40; ++i) {
      const Quat turned = glm::angleAxis(0.05 * i, Vec3(0, 0, 1));
      const Pose from = pose_at(Vec3(10, 20, 700), turned), to = pose_at(Vec3(10, 20, 400), turned);
      const LatticePose at = *to_lattice(from, *scene);
      collinear +=
          exact::raw_normal({transform(at, a), transform(at, b), transform(at, c)}) == exact::Normal{};
      const auto found = first_contact(*backend, *scene, from, to, TouchRule{.tolerance = 0, .early = 16});
      ASSERT_TRUE(found) << found.error().sentence;
      ASSERT_EQ(found->kind, FirstContact::Kind::kContact) << backend->name() << ' ' << i;
      EXPECT_LE(found->time, (700.0 - 512) / 300) << "late";
      EXPECT_GE(found->time, (700.0 - 512 - 17) / 300) << "early";
    }
  }
  EXPECT_GT(collinear, 0);
}

TEST(FirstContact, OfABladeTurningIntoAWallIsWhereItsEdgeReachesIt) {
  // A blade 0.1 long turns about z; the wall is the plane y = 0.05: it is reached at 30°.
  Asked asked(solids::box(Vec3(-0.2, 0.05, -0.05), Vec3(0.2, 0.1, 0.05)),
              solids::box(Vec3(0, -0.001, -0.01), Vec3(0.1, 0.001, 0.01)));
  const double step = asked.geometry.lattice.step_m;
  const FirstContact found =
      asked.first(pose_at(Vec3(0)), pose_at(Vec3(0), rotation_by(Vec3(0, 0, kPi / 2))));
  ASSERT_EQ(found.kind, FirstContact::Kind::kContact);
  const double angle = found.time * kPi / 2, height = 0.1 * std::sin(angle) + 0.001 * std::cos(angle);
  EXPECT_LE(height, 0.05 + 3 * step) << "late";
  EXPECT_GE(height, 0.05 - TouchRule::of(asked.geometry, 0).early * step - 3 * step) << "too early";
}

TEST(FirstContact, OfABallThatTurnsPastAWallIsNone) {
  // 0.6 mm beside the wall it goes along and turns by 170°; a millimetre nearer it meets the wall.
  Asked asked(solids::box(Vec3(-0.05, -0.05, -0.001), Vec3(-0.0051, 0.05, 0.001)), solids::sphere(0.0045));
  const Quat turned = rotation_by(Vec3(0, 0, 170 * kPi / 180));
  EXPECT_EQ(asked.first(pose_at(Vec3(0, 0, -0.02)), pose_at(Vec3(0, 0, 0.02), turned)).kind,
            FirstContact::Kind::kNone);
  EXPECT_EQ(asked.first(pose_at(Vec3(-0.001, 0, -0.02)), pose_at(Vec3(-0.001, 0, 0.02), turned)).kind,
            FirstContact::Kind::kContact);
}

TEST(FirstContact, DependsOnNothingThatIsAskedInBetween) {
  Asked asked(solids::box(Vec3(-0.03), Vec3(0.03), Int3(4, 5, 6)), solids::sphere(0.015));
  const Screw falls(pose_at(Vec3(0.004, 0.003, 0.05)), pose_at(Vec3(0.004, 0.003, 0)), asked.geometry),
      passes(pose_at(Vec3(-0.03, 0, 0.05), rotation_by(Vec3(1, 0, 0))),
             pose_at(Vec3(0.03, 0, 0.0465), rotation_by(Vec3(0, 1, 2))), asked.geometry);
  // Free times of a motion one after the other, and between them some of another.
  const auto follow = [&](const Screw& screw, const Screw* another) {
    std::vector<double> out;
    ScrewMotion motion(screw);
    double time = 0;
    for (int i = 0; i < 6 && time < 1; ++i) {
      FreeTime free;
      const LatticePose pose = *to_lattice(screw.at(time), asked.geometry);
      if (pose.beyond_lattice) break;
      EXPECT_TRUE(asked.native->free_time(pose, motion, time, free));
      out.push_back(free.time);
      time += free.time;
      if (another == nullptr) continue;
      ScrewMotion other(*another);
      EXPECT_TRUE(asked.native->free_time(*to_lattice(another->at(0), asked.geometry), other, 0, free));
      asked.touches(another->at(0.5));
    }
    return out;
  };
  const std::vector<double> alone = follow(falls, nullptr);
  EXPECT_GT(alone.size(), 1u);
  EXPECT_EQ(alone, follow(falls, &passes));
  EXPECT_EQ(follow(passes, nullptr), follow(passes, &falls));
}

TEST(FirstContact, OfATriangleAloneIsWhereItIs) {
  // A tool of one run of triangles, and one of a single triangle.
  Mesh lone;
  lone.vertices = {Vec3(-0.01, -0.01, 0), Vec3(0.01, -0.01, 0), Vec3(0, 0.01, 0)};
  lone.triangles = {{0, 1, 2}};
  for (const Mesh& tool : {lone, solids::box(Vec3(-0.01, -0.01, 0), Vec3(0.01, 0.01, 0.02))}) {
    Asked asked(solids::box(Vec3(-0.2, -0.2, -0.05), Vec3(0.2, 0.2, 0)), tool);
    const double early = TouchRule::of(asked.geometry, 0).early * asked.geometry.lattice.step_m,
                 step = asked.geometry.lattice.step_m;
    const FirstContact found = asked.first(pose_at(Vec3(0, 0, 0.1)), pose_at(Vec3(0, 0, -0.02)));
    ASSERT_EQ(found.kind, FirstContact::Kind::kContact);
    const double height = 0.1 - 0.12 * found.time;
    EXPECT_GE(height, -3 * step) << "late";
    EXPECT_LE(height, early + 3 * step) << "too early";
  }
}

TEST(FirstContact, OfALongTriangleIsDecidedThoughDoublesAreOffByMore) {
  // Edges of a metre: a distance in doubles is off by more than contact is early.
  Asked asked(solids::box(Vec3(-0.6, -0.02, -0.01), Vec3(0.6, 0.02, 0)),
              solids::box(Vec3(-0.5, -0.005, 0), Vec3(0.5, 0.005, 0.004)));
  const Quat tilted = rotation_by(Vec3(0.002, 0.003, 0.1));
  const FirstContact found =
      asked.first(pose_at(Vec3(0, 0, 0.05), tilted), pose_at(Vec3(0.001, 0, -0.01), tilted));
  EXPECT_EQ(found.kind, FirstContact::Kind::kContact);
}

TEST(FirstContact, OfWhatTouchesAtTheStartIsTheStart) {
  Asked asked(solids::box(Vec3(-0.1), Vec3(0.1)), solids::sphere(0.01));
  const FirstContact inside =
      asked.first(pose_at(Vec3(0)), pose_at(Vec3(0, 0, 0.05)));  // contained, and meets nothing
  EXPECT_EQ(inside.kind, FirstContact::Kind::kContact);
  EXPECT_EQ(inside.time, 0);
}

TEST(FirstContact, IsNeverLateAgainstDenseSamplingAndEndsWhereSomethingIsNear) {
  const Mesh ball = solids::sphere(0.03);
  Asked on_ball(ball, solids::box(Vec3(-0.02, -0.004, -0.003), Vec3(0.02, 0.004, 0.003)));
  Asked on_corner(solids::box(Vec3(-0.03), Vec3(0.03), Int3(4, 5, 6)), solids::sphere(0.015));
  equivalence::Random random(11);
  int contacts = 0, clear = 0;
  for (int i = 0; i < 300; ++i) {
    Asked& asked = i % 2 == 0 ? on_ball : on_corner;
    const auto some = [&] { return 2 * random.unit() - 1; };
    const Pose from = pose_at(0.09 * Vec3(some(), some(), some()),
                              rotation_by(2.0 * Vec3(some(), some(), some()))),
               to = pose_at(0.09 * Vec3(some(), some(), some()),
                            rotation_by(1.7 * Vec3(some(), some(), some())) * from.rotation);
    const FirstContact found = asked.first(from, to);
    ASSERT_NE(found.kind, FirstContact::Kind::kUndecided);
    if (found.time == 0) {
      EXPECT_TRUE(asked.touches(from)) << "motion " << i;
      ++contacts;
      continue;
    }
    const Screw screw(from, to, asked.geometry);
    const double until = found.kind == FirstContact::Kind::kNone ? 1 : found.time;
    for (int k = 0; k < 400; ++k)
      ASSERT_FALSE(asked.touches(screw.at(until * k / 400.0)))
          << "late: motion " << i << ", sample " << k << " of 400 until " << until;
    if (found.kind == FirstContact::Kind::kNone) {
      ++clear;
      continue;
    }
    ++contacts;
    Clearance near;
    ASSERT_TRUE(
        asked.native->clearance(*to_lattice(screw.at(found.time), asked.geometry), INT32_MAX - 2, near));
    if (near.kind == Clearance::Kind::kApart) {
      EXPECT_LE(near.steps, TouchRule::of(asked.geometry, 0).early) << "early: motion " << i;
    }
  }
  EXPECT_GT(contacts, 50);
  EXPECT_GT(clear, 50);
}

TEST(FirstContact, OfTheReferenceKeepsTheSamePromise) {
  const SceneGeometry geometry = std::move(
      *build_geometry(solids::box(Vec3(-0.1, -0.1, -0.02), Vec3(0.1, 0.1, 0)), solids::sphere(0.01), {}));
  const auto ref = make_ref_backend();
  ASSERT_TRUE(ref->prepare(geometry, Plan{}, [](const char*, double) { return true; }));
  double lowest = 0;
  for (const Int3& v : geometry.tool.vertices) lowest = std::min(lowest, v.z * geometry.lattice.step_m);
  const TouchRule rule = TouchRule::of(geometry, 0);
  const auto found =
      first_contact(*ref, geometry, pose_at(Vec3(0, 0, 0.05)), pose_at(Vec3(0.01, 0, -0.01)), rule);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->kind, FirstContact::Kind::kContact);
  const double height = 0.05 - 0.06 * found->time + lowest;
  EXPECT_GE(height, 0);
  EXPECT_LE(height, rule.early * geometry.lattice.step_m);
}

TEST(Tolerance, LetsAContactShallowerThanItPass) {
  SceneGeometry geometry = std::move(
      *build_geometry(solids::box(Vec3(-0.05, -0.05, -0.02), Vec3(0.05, 0.05, 0), Int3(10, 10, 4)),
                      solids::box(Vec3(-0.01, -0.01, 0), Vec3(0.01, 0.01, 0.02), Int3(4, 4, 4)), {}));
  geometry.contact_samples = 0;
  const auto native = make_native_backend();
  ASSERT_TRUE(native->prepare(geometry, Plan{}, [](const char*, double) { return true; }));
  const TouchRule rule = TouchRule::of(geometry, 100e-6);
  const double step = geometry.lattice.step_m;
  for (const auto& [depth, expected] :
       {std::pair{-10e-6, false}, std::pair{10e-6, false}, std::pair{95e-6, false}, std::pair{105e-6, true},
        std::pair{1e-3, true}}) {
    const auto touch = touch_at(*native, *to_lattice(pose_at(Vec3(0, 0, -depth)), geometry), rule);
    ASSERT_TRUE(touch);
    EXPECT_EQ(touch->touches, expected) << depth;
    if (depth > 0) {
      EXPECT_NEAR(static_cast<double>(touch->depth) * step, depth, 4 * step);
    }
  }
  const auto found =
      first_contact(*native, geometry, pose_at(Vec3(0, 0, 0.002)), pose_at(Vec3(0, 0, -0.002)), rule);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->kind, FirstContact::Kind::kContact);
  EXPECT_LT(found->static_id, geometry.mockup.triangles.size());
  EXPECT_LT(found->mobile_id, geometry.tool.triangles.size());
  const double depth = 0.004 * found->time - 0.002;
  EXPECT_LE(depth, 100e-6 + 4 * step) << "late";
  EXPECT_GE(depth, 100e-6 - 2 * rule.early * step) << "too early";
  EXPECT_EQ(
      first_contact(*native, geometry, pose_at(Vec3(0, 0, 0.002)), pose_at(Vec3(0, 0, -0.00009)), rule)->kind,
      FirstContact::Kind::kNone);
}

}  // namespace
}  // namespace palpate
