#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "model/contact/response.h"
#include "model/lattice/pose.h"
#include "model/scene/geometry_build.h"
#include "tests/cpu_ref/bench_backend.h"

namespace palpate {

/// A mock-up and a tool, prepared by the reference (tests/equivalence: by both back ends); what tests ask
/// poses of. Metres, newtons.
struct BenchScene {
  static constexpr double kStiffness = 2000;  // N/m, the default of a scene

  BenchScene(const Mesh& mockup, const Mesh& tool, const GeometrySettings& settings = {},
             Profile profile = Profile::kRefined) {
    Result<SceneGeometry> built = build_geometry(mockup, tool, settings);
    if (!built) throw std::runtime_error(built.error().sentence);
    geometry = std::make_unique<SceneGeometry>(std::move(*built));
    plan.profile = profile;
    if (const Result<void> prepared = backend->prepare(*geometry, plan, {}); !prepared)
      throw std::runtime_error(prepared.error().sentence);
  }

  const ContactResponse& ask(const Pose& pose) {
    const Result<LatticePose> rounded = to_lattice(pose, *geometry);
    if (!rounded) throw std::runtime_error(rounded.error().sentence);
    if (const Result<void> answered = backend->query(*rounded, nullptr, contacts); !answered)
      throw std::runtime_error(answered.error().sentence);
    respond(contacts, *rounded, *geometry, plan.profile, kStiffness, response);
    return response;
  }
  const ContactResponse& ask(const Vec3& position) { return ask(Pose{position, Quat(1, 0, 0, 0)}); }

  double voxel() const { return geometry->mockup_grid.size * geometry->lattice.step_m; }  ///< m
  double spacing() const { return geometry->sample_spacing * geometry->lattice.step_m; }  ///< m

  std::unique_ptr<SceneGeometry> geometry;
  Plan plan;
  std::unique_ptr<CollisionBackend> backend = make_bench_backend();
  Contacts contacts;
  ContactResponse response;
};

/// Angle between two directions, degrees.
inline double angle_deg(const Vec3& a, const Vec3& b) {
  const double sine = glm::length(glm::cross(a, b)), cosine = glm::dot(a, b);
  return std::atan2(sine, cosine) * 180 / 3.14159265358979323846;
}

}  // namespace palpate
