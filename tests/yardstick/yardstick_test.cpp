// The yardstick's truths are right: the rigid tool, put where a truth's force and torque leave the springs,
// just touches. Its metrics are right: a stub with a known error gives the known figure.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "bench/haptic/measure.h"
#include "bench/haptic/on_plane.h"
#include "bench/haptic/parts.h"
#include "bench/haptic/solids.h"
#include "bench/haptic/voxel_map.h"
#include "bench/haptic/vps.h"

namespace yardstick {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::vector<Case> all_cases() {
  const Amount few{23, 41, 20};
  std::vector<Case> out;
  for (auto make : {closed_forms, fits, stiff_cases})
    for (Case& subject : make(few)) out.push_back(std::move(subject));
  return out;
}

/// Whether an edge of one mesh passes through a triangle of the other's: plain floating point, all with all.
bool edges_pierce(const std::vector<Vec3>& a, const TriMesh& ma, const std::vector<Vec3>& b,
                  const TriMesh& mb) {
  for (const auto& t : mb.triangles) {
    const Vec3 &p = b[t[0]], &q = b[t[1]], &r = b[t[2]];
    const Vec3 normal = glm::cross(q - p, r - p), low = glm::min(p, glm::min(q, r)),
               high = glm::max(p, glm::max(q, r));
    for (const auto& s : ma.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &from = a[s[i]], &to = a[s[(i + 1) % 3]];
        if (glm::any(glm::greaterThan(glm::min(from, to), high)) ||
            glm::any(glm::lessThan(glm::max(from, to), low)))
          continue;
        const double here = glm::dot(from - p, normal), there = glm::dot(to - p, normal);
        if (here * there >= 0) continue;
        const Vec3 x = from + here / (here - there) * (to - from);
        if (glm::dot(glm::cross(q - p, x - p), normal) > 0 &&
            glm::dot(glm::cross(r - q, x - q), normal) > 0 && glm::dot(glm::cross(p - r, x - r), normal) > 0)
          return true;
      }
  }
  return false;
}

bool surfaces_cross(const Case& subject, const Pose& pose) {
  std::vector<Vec3> tool;
  for (const Vec3& v : subject.tool.vertices) tool.push_back(pose.rotation * v + pose.position);
  return edges_pierce(tool, subject.tool, subject.fixed.vertices, subject.fixed) ||
         edges_pierce(subject.fixed.vertices, subject.fixed, tool, subject.tool);
}

TEST(Truths, LeaveTheRigidToolWhereItJustTouches) {
  for (const Case& subject : all_cases()) {
    SCOPED_TRACE(subject.name);
    ASSERT_EQ(subject.truths.size(), subject.path.size());
    if (!subject.truths.back().force) continue;  // two walls press: there is no such place
    // So much less than the truth leaves the tool inside, so much more frees it. A tilted peg's rims are no
    // circles, by a micrometre; the arm's ball, once turned, doesn't touch with a vertex.
    const double little = subject.name == "ball on an arm" ? 0.01 : 0.003;
    const double k = subject.stiffness, turning = k * subject.gyration * subject.gyration;
    for (const std::size_t i : {subject.path.size() / 2, subject.path.size() - 1}) {
      const Truth& truth = subject.truths[i];
      const auto at = [&](double part) {
        return moved(subject.path[i], part * *truth.force / k, part * *truth.torque / turning);
      };
      EXPECT_TRUE(surfaces_cross(subject, at(0)));
      EXPECT_TRUE(surfaces_cross(subject, at(1 - little)));
      EXPECT_FALSE(surfaces_cross(subject, at(1 + little)));
    }
  }
}

TEST(Truths, OfTheBallOnAnArmIsTheLeastOfTheSpringsEnergy) {
  for (const Case& subject : all_cases()) {
    if (subject.name != "ball on an arm") continue;
    const double k = subject.stiffness, rho = subject.gyration;
    const Pose& hand = subject.path.back();
    double lowest = 1;  // of the ball that touches, by its vertices
    const auto height = [&](double lift, double turn) {
      double out = 1;
      const Pose pose = moved(hand, Vec3(0, 0, lift), Vec3(0, turn, 0));
      for (const Vec3& v : subject.tool.vertices) out = std::min(out, (pose.rotation * v + pose.position).z);
      return out;
    };
    for (int i = 0; i <= 400; ++i) {  // at every turn the lift that frees it, by brute force
      const double turn = 0.05 * i / 400, lift = -height(0, turn);
      lowest = std::min(lowest, k / 2 * (lift * lift + rho * rho * turn * turn));
    }
    const Truth& truth = subject.truths.back();
    const double u = truth.force->z / k, turn = truth.torque->y / (k * rho * rho);
    // The ball's facets lie up to a thousandth of its radius inside: 10 µm of 1 mm, twice that of an energy.
    EXPECT_NEAR(k / 2 * (u * u + rho * rho * turn * turn), lowest, 0.02 * lowest);
    EXPECT_GT(turn, 0.001);
  }
}

TEST(Loops, EndWhereTheyBegin) {
  for (const Case& subject : all_cases()) {
    SCOPED_TRACE(subject.name);
    EXPECT_LT(glm::length(subject.loop.front().position - subject.loop.back().position), 1e-12);
    EXPECT_LT(glm::length(turn_between(subject.loop.front().rotation, subject.loop.back().rotation)), 1e-12);
  }
}

/// Answers by a function of the hand's pose.
class Stub final : public Adapter {
 public:
  explicit Stub(std::function<Wrench(const Pose&)> law) : law_(std::move(law)) {}
  std::string name() const override { return "stub"; }
  std::string version() const override { return ""; }
  void prepare(const Case&) override {}
  Answer answer(const Pose& hand) override { return {law_(hand), 1, true}; }

 private:
  std::function<Wrench(const Pose&)> law_;
};

/// A box of 40 × 40 × 20 mm in the ground: K d along z.
struct Metrics : testing::Test {
  Case subject =
      on_plane("box", "", box(Vec3(-0.02, -0.02, -0.01), Vec3(0.02, 0.02, 0.01)), 0.001, {101, 201, 400});

  Vec3 right(const Pose& hand) const {
    return Vec3(0, 0, subject.stiffness * std::max(0.0, 0.01 - hand.position.z));
  }
  Figures of(std::function<Wrench(const Pose&)> law) {
    Stub stub(std::move(law));
    return figures_of(subject, measure(stub, subject, 400, true));
  }
};

TEST_F(Metrics, FindNoFaultWithTheTruth) {
  const Figures f = of([&](const Pose& hand) { return Wrench{right(hand), Vec3(0)}; });
  EXPECT_LT(*f.direction_p95_deg, 1e-9);
  EXPECT_LT(*f.magnitude_p95, 1e-9);
  EXPECT_LT(*f.torque_p95, 1e-9);
  EXPECT_NEAR(f.step, 1, 1e-6);
  EXPECT_NEAR(f.noise, std::sqrt(1.0 / 3), 0.05);  // one axis of three pushes; 400 draws tell it to 4 %
  EXPECT_LT(f.loop_lost, 1e-9);
  EXPECT_EQ(f.unsettled, 0);
}

TEST_F(Metrics, TellAKnownErrorOfDirectionMagnitudeAndTorque) {
  const Figures f = of([&](const Pose& hand) {
    const Vec3 force = turn_by(Vec3(0, 5 * kPi / 180, 0)) * right(hand) * 1.1;
    return Wrench{force, Vec3(0.2 * subject.gyration * glm::length(right(hand)), 0, 0)};
  });
  EXPECT_NEAR(*f.direction_p50_deg, 5, 1e-9);
  EXPECT_NEAR(*f.direction_p95_deg, 5, 1e-9);
  EXPECT_NEAR(*f.magnitude_p50, 0.1, 1e-9);
  EXPECT_NEAR(*f.torque_p95, 0.2, 1e-9);
}

TEST_F(Metrics, ASilentMethodIsOffByARightAngleAndByAll) {
  const Figures f = of([](const Pose&) { return Wrench{}; });
  EXPECT_EQ(*f.direction_p50_deg, 90);
  EXPECT_EQ(*f.magnitude_p50, 1);
  EXPECT_EQ(f.step, 0);
}

TEST_F(Metrics, TellAStep) {
  // The path has steps of 11 µm, 0.022 N; at half its depth a newton more.
  const Figures f = of([&](const Pose& hand) {
    return Wrench{right(hand) + Vec3(0, 0, hand.position.z < 0.0095 ? 1 : 0), Vec3(0)};
  });
  EXPECT_NEAR(f.step, 1.022 / 0.022, 1e-3);
}

TEST_F(Metrics, TellTheWorkThatARubbingForceTakes) {
  // Forces that always oppose x twice as much on the way out as they help on the way back.
  const Pose deep = subject.rest;
  subject.loop = along({deep, moved(deep, Vec3(0.01, 0, 0), Vec3(0)), deep}, 201);
  int asked = 0;
  Stub stub([&](const Pose&) {
    const bool back = asked++ > 101 * 2 + 100;  // after two walks along the path, and the way out
    return Wrench{Vec3(back ? -1 : -2, 0, 0), Vec3(0)};
  });
  const Figures f = figures_of(subject, measure(stub, subject, 0, true));
  EXPECT_NEAR(f.loop_lost, 1.0 / 3, 0.005);  // (2 − 1) / (2 + 1); the change lies within one of 200 steps
}

TEST_F(Metrics, CountTurnsInStepsAndWork) {
  const Pose start = subject.rest;
  subject.path = {start, moved(start, Vec3(0), Vec3(0, 0, 0.01))};
  subject.truths.clear();
  subject.loop = along({start, moved(start, Vec3(0), Vec3(0, 0, 0.01)), start}, 21);
  const Figures f = of([&](const Pose& hand) {
    const double turn = turn_between(start.rotation, hand.rotation).z;
    return Wrench{Vec3(turn, 0, 0), Vec3(0, 0, -turn)};
  });
  EXPECT_NEAR(f.step, 0.01 / (subject.stiffness * 0.01 * 0.03), 1e-6);  // the box reaches 30 mm
  EXPECT_LT(f.loop_lost, 1e-9);
}

TEST(Quantiles, LieBetweenNeighbours) {
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile({0, 1}, 0.95), 0.95);
  EXPECT_EQ(quantile({}, 0.5), 0);
}

TEST(Meshes, HaveTheirCentreAndRadiusOfGyration) {
  const TriMesh cube = shifted(box(Vec3(-0.01), Vec3(0.01)), Vec3(0.1, 0.2, 0.3));
  EXPECT_LT(glm::length(centre_of_volume(cube) - Vec3(0.1, 0.2, 0.3)), 1e-12);
  EXPECT_NEAR(gyration_radius(box(Vec3(-0.01), Vec3(0.01))), 0.01 * std::sqrt(5.0 / 3), 1e-12);
  // All solids are closed and outwards: their volume is what it should be.
  const auto volume = [](const TriMesh& mesh) {
    double out = 0;
    for (const auto& t : mesh.triangles)
      out += glm::dot(mesh.vertices[t[0]], glm::cross(mesh.vertices[t[1]], mesh.vertices[t[2]])) / 6;
    return out;
  };
  const double many = 96 * std::tan(kPi / 96);  // of a polygon about the unit circle
  EXPECT_NEAR(volume(cylinder(2, 3, 96)), many * 4 * 3, 1e-9);
  EXPECT_NEAR(volume(cone(2, 3, 96)), many * 4, 1e-9);
  EXPECT_NEAR(volume(ring(1, 2, 3, 96)), many * (4 - 1) * 3, 1e-9);
  EXPECT_NEAR(volume(sphere(1, 96)), 4 * kPi / 3, 0.01);  // facets lie inside
}

TEST(VoxelMap, KnowsSurfaceInsideAndFree) {
  VoxelMap map;
  map.build(box(Vec3(0), Vec3(0.064, 0.064, 0.064)), 64);
  Vec3 centre(0);
  EXPECT_EQ(map.at(Vec3(-0.003, 0.03, 0.03), centre), 0);
  EXPECT_EQ(map.at(Vec3(0.032, 0.032, 0.0001), centre), 1);
  EXPECT_EQ(map.at(Vec3(0.032, 0.032, 0.0072), centre), 8);  // the voxel about 7 mm, seven from the surface's
  EXPECT_NEAR(centre.z, 0.007, 1e-9);
}

TEST(Vps, PushesABoxOutOfTheGround) {
  Case subject = on_plane("box", "", box(Vec3(-0.02, -0.02, -0.01), Vec3(0.02, 0.02, 0.01)), 0.001, {});
  const auto vps = make_vps();
  vps->prepare(subject);
  const Answer deep = vps->answer(subject.path.back());
  EXPECT_TRUE(deep.settled);
  // Ten springs of K behind one leave 10/11 of 2 N; surfaces are known to a voxel of 0.23 mm.
  EXPECT_NEAR(deep.wrench.force.z, 2.0 * 10 / 11, 2000 * 0.00024);
  EXPECT_LT(std::hypot(deep.wrench.force.x, deep.wrench.force.y), 0.01);
  EXPECT_EQ(vps->answer(moved(subject.rest, Vec3(0, 0, 0.01), Vec3(0))).wrench.force, Vec3(0));
}

TEST(Parts, AreRefusedInASentenceThatNamesTheFile) {
  const auto sentence = [](const std::string& files) -> std::string {
    try {
      part(files, {});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(sentence("gear"), testing::HasSubstr("'gear' is not NAME="));
  EXPECT_THAT(sentence("gear=a.ply,b.ply,c.csv"), testing::HasSubstr("'a.ply': can't be read"));
  const std::string file = testing::TempDir() + "yardstick_short.ply";
  std::ofstream(file)
      << "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float "
         "y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(sentence("gear=" + file + ",b,c"), testing::HasSubstr("ends too early"));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace yardstick
