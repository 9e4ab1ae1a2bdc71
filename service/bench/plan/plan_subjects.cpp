#include "service/bench/plan/plan_subjects.h"

#include <cmath>

#include "model/generate/solids.h"
#include "model/scene/scene.h"

namespace palpate {
namespace {

constexpr double kMm = 1e-3;
constexpr std::size_t kPoses = 24;

/// From just above a face at z = 0 to `deepest` below it, wandering over the face; turned all ways if
/// `turns`.
std::vector<Pose> presses(double reach, double deepest, bool turns) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < kPoses; ++i) {
    const double k = static_cast<double>(i), depth = deepest * (k - 2) / static_cast<double>(kPoses - 3);
    const Vec3 at(3.171 * kMm * static_cast<double>(i % 7) - 9 * kMm,
                  2.339 * kMm * static_cast<double>(i % 5) - 5 * kMm, reach - depth);
    out.push_back(
        {at, turns ? glm::angleAxis(0.37 * k, glm::normalize(Vec3(1, 2 - 0.1 * k, 3))) : Quat(1, 0, 0, 0)});
  }
  return out;
}

Mesh one_triangle(double size) {
  Mesh mesh;
  mesh.vertices = {Vec3(-size, -size, 0), Vec3(size, -size, 0), Vec3(0, size, 0)};
  mesh.triangles = {{0, 1, 2}};
  mesh.parts = {{"", 0, 1}};
  return mesh;
}

/// A square of n × n × 2 triangles that bends with a radius of 200 mm: a sheet without a sharp edge.
Mesh bent_sheet(double half, int n) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const double u = half * (2.0 * x / n - 1), v = half * (2.0 * y / n - 1);
      mesh.vertices.push_back(Vec3(u, v, -(u * u + v * v) / 0.4));
    }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  mesh.parts = {{"", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

/// The lower half of a ball: an open tool.
Mesh bowl(double radius) {
  Mesh ball = solids::sphere(radius, 32, 16);
  Mesh mesh;
  mesh.vertices = ball.vertices;
  for (const auto& triangle : ball.triangles) {
    double z = 0;
    for (const std::uint32_t v : triangle) z += ball.vertices[v].z;
    if (z < 0) mesh.triangles.push_back(triangle);
  }
  mesh.parts = {{"", 0, static_cast<std::uint32_t>(mesh.triangles.size())}};
  return mesh;
}

}  // namespace

std::vector<PlanSubject> plan_subjects() {
  const double radius = 10 * kMm;
  const auto block = [](double depth) {
    return solids::box(Vec3(-40, -40, -depth) * kMm, Vec3(40, 40, 0) * kMm, Int3(6, 6, 1));
  };
  const Mesh ball = solids::sphere(radius, 32, 16),
             cube = solids::box(Vec3(-8, -8, -8) * kMm, Vec3(8, 8, 8) * kMm, Int3(3));
  // A ball's top at z = 0, so that the same presses meet it.
  const auto round_block = [](double r, std::uint64_t triangles) {
    return solids::moved(solids::sphere_of(r, triangles), Pose{Vec3(0, 0, -r), Quat(1, 0, 0, 0)});
  };

  PlanSubject whole;
  whole.mockup = block(40);
  whole.tool = cube;
  whole.settings.voxel_size_m = 2 * kMm;
  whole.settings.centre_of_mass_m = Vec3(0);
  whole.poses = presses(radius, 9 * kMm, true);
  std::vector<PlanSubject> out;
  const auto add = [&](const char* name, const char* about, auto change) {
    PlanSubject subject = whole;
    subject.name = name;
    subject.about = about;
    change(subject);
    out.push_back(std::move(subject));
  };
  add("everything", "lacks nothing", [](PlanSubject&) {});
  add("no_inside", "a plate as thin as a voxel: no V_int voxel",
      [&](PlanSubject& s) { s.mockup = block(2); });
  add("all_smooth", "a round mock-up: no sharp edge",
      [&](PlanSubject& s) { s.mockup = round_block(30 * kMm, 6000); });
  add("sheet", "an open, bent sheet: no inside, no sharp edge",
      [&](PlanSubject& s) { s.mockup = bent_sheet(40 * kMm, 24); });
  add("no_torque", "a device without torque axes", [](PlanSubject& s) { s.torque_wanted = false; });
  add("nobody_watching", "no viewer and no recording", [](PlanSubject& s) { s.subscribers = false; });
  add("far_tool", "a tool that stays away", [](PlanSubject& s) {
    for (Pose& pose : s.poses) pose.position.z += 0.3;
  });
  add("one_triangle", "a mock-up of one triangle",
      [&](PlanSubject& s) { s.mockup = one_triangle(30 * kMm); });
  add("one_triangle_tool", "a tool of one triangle", [&](PlanSubject& s) {
    s.tool = one_triangle(6 * kMm);
    s.poses = presses(3 * kMm, 9 * kMm, true);
  });
  add("open_tool", "a tool without inside", [&](PlanSubject& s) { s.tool = bowl(radius); });
  add("swallowed", "a tool wholly inside, no torque", [&](PlanSubject& s) {
    s.torque_wanted = false;
    s.tool = solids::sphere(4 * kMm, 16, 8);
    s.poses = presses(-6 * kMm, 9 * kMm, true);
  });
  add("large_contact", "a smooth mock-up with many triangles in contact", [&](PlanSubject& s) {
    s.mockup = round_block(30 * kMm, 120'000);
    s.tool = ball;
    s.torque_wanted = false;
    s.poses.resize(12);
  });
  add("paper", "profile paper, no torque", [](PlanSubject& s) {
    s.profile = Profile::kPaper;
    s.torque_wanted = false;
  });
  add("paper_smooth", "profile paper on a round mock-up, nobody watching", [&](PlanSubject& s) {
    s.profile = Profile::kPaper;
    s.mockup = round_block(30 * kMm, 6000);
    s.subscribers = false;
  });
  add("paper_thin", "profile paper on a plate as thin as a voxel", [&](PlanSubject& s) {
    s.profile = Profile::kPaper;
    s.mockup = block(2);
  });
  add("large_sheet", "a sheet of many triangles, no torque", [&](PlanSubject& s) {
    s.mockup = bent_sheet(40 * kMm, 320);
    s.tool = ball;
    s.torque_wanted = false;
    s.poses = presses(radius, 6 * kMm, false);
    s.poses.resize(12);
  });
  add("nothing", "a sheet, no torque, nobody watching", [&](PlanSubject& s) {
    s.mockup = bent_sheet(40 * kMm, 24);
    s.tool = ball;
    s.torque_wanted = s.subscribers = false;
    s.poses = presses(radius, 6 * kMm, false);
  });
  return out;
}

PlanFacts facts_of(const PlanSubject& subject, const SceneGeometry& geometry) {
  Scene scene;
  scene.response.profile = subject.profile;
  PlanFacts facts = query_facts(scene, geometry);
  facts.torque_wanted = subject.torque_wanted;
  facts.subscribers = subject.subscribers;
  return facts;
}

}  // namespace palpate
