#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "compute/gpu/gpu_backend.h"
#include "cpu_ref/ref_backend.h"
#include "model/generate/solids.h"
#include "model/lattice/pose.h"
#include "model/scene/geometry_build.h"
#include "tests/equivalence/contacts_difference.h"

namespace palpate {

/// A scene and a pose of it that together fill every list of a frame: a ball over a corner, a needle, a plate
/// run through.
struct FaultScene {
  std::string name;
  SceneGeometry geometry;
  LatticePose pose;
  Contacts expected;  ///< the reference's answer at `pose`
};

inline Result<void> prepare(CollisionBackend& backend, const FaultScene& scene) {
  return backend.prepare(scene.geometry, {}, [](const char*, double) { return true; });
}

inline LatticePose at(const FaultScene& scene, const Vec3& position) {
  return *to_lattice(Pose{position, Quat(1, 0, 0, 0)}, scene.geometry);
}

inline std::unique_ptr<FaultScene> make_fault_scene(std::string name, const Mesh& mockup, const Mesh& tool,
                                                    const Vec3& position) {
  GeometrySettings settings;
  settings.voxel_size_m = 0.002;
  auto geometry = build_geometry(mockup, tool, settings);
  if (!geometry) throw std::runtime_error(geometry.error().sentence);
  std::unique_ptr<FaultScene> scene(new FaultScene{std::move(name), std::move(*geometry), {}, {}});
  scene->pose = at(*scene, position);
  const auto reference = make_ref_backend();
  if (auto prepared = prepare(*reference, *scene); !prepared)
    throw std::runtime_error(prepared.error().sentence);
  if (auto answered = reference->query(scene->pose, nullptr, scene->expected); !answered)
    throw std::runtime_error(answered.error().sentence);
  return scene;
}

/// A ball of 20 mm pressed into the edge of a block: crossings, samples, several zones.
inline std::unique_ptr<FaultScene> ball_on_edge() {
  return make_fault_scene("ball on an edge",
                          solids::box(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0), Int3(8, 8, 4)),
                          solids::sphere(0.01, 24, 12), Vec3(0.039, 0.001, 0.0065));
}

/// A needle thinner than the spacing of samples, tip down.
inline std::unique_ptr<FaultScene> needle_in_block() {
  return make_fault_scene("needle", solids::box(Vec3(-0.04, -0.04, -0.02), Vec3(0.04, 0.04, 0)),
                          solids::revolve({{1e-6, 0}, {1e-4, 0.02}}, 12, solids::Ends::kPoints),
                          Vec3(0.00025, 0.00025, -0.003));
}

/// A ball right through a plate of 1 mm: its faces pierce each other.
inline std::unique_ptr<FaultScene> ball_in_plate() {
  return make_fault_scene("ball in a plate", solids::box(Vec3(-0.04, -0.04, -0.001), Vec3(0.04, 0.04, 0)),
                          solids::sphere(0.01, 24, 12), Vec3(0.001, 0.002, 0.003));
}

}  // namespace palpate
