#pragma once
#include <functional>
#include <stdexcept>

#include "model/collision_backend.h"
#include "model/scene.h"

namespace palpate {

/// A scene without meshes: the tool is its own origin, a point; the mock-up is everything below z = 0.
inline LoadedScene half_space_scene() {
  LoadedScene scene;
  scene.scene.file = "half_space.json";
  scene.geometry.lattice.step_m = 1.0 / (1 << 20);
  scene.geometry.tool_radius = 2;
  scene.geometry.mockup_grid = {.origin = Int3(-(1 << 24)), .size = 1 << 20, .bricks = Int3(4)};   // ±16 m
  scene.scene.response.stiffness_n_per_m = 1000;
  scene.scene.control.fade_in_ms = 0;
  return scene;
}

/// A hand that goes straight down, into the half-space and out again: z = 10 mm, −10 mm at half time, 10 mm.
inline void add_dip(LoadedScene& scene, double duration_s) {
  auto& path = scene.scene.device.path;
  path.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    path[i].time_s = 0.5 * duration_s * static_cast<double>(i);
    path[i].pose.position.z = i == 1 ? -0.01 : 0.01;
    path[i].stage = static_cast<int>(i) + 1;
  }
  scene.scene.start = path.front().pose;
}

/// Answers for the half-space as a back end would: one area, n_c = z, depth = −z.
class HalfSpace : public CollisionBackend {
 public:
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override { return {}; }
  Result<void> query(const LatticePose& pose, const Held*, Contacts& out) override {
    ++queries;
    if (on_query)
      if (auto done = on_query(queries); !done) return done;
    out = {};
    const std::int64_t depth = -std::int64_t{pose.translation.z};
    if (depth <= 0) return {};
    out.contact = true;
    out.cst = {0};
    ContactArea area;
    area.static_ids = {0};
    area.direction = Int3(0, 0, 1 << 28);
    area.rays = 1;
    area.weight_sum = std::int64_t{1} << 30;
    area.height_sum = depth * 4;   // d = |D|·step·height/weight = 2^28·h/2^30 steps
    area.faded_sum = area.height_sum;
    area.height_slope = area.weight_sum;
    area.max_height = static_cast<std::uint32_t>(depth * 4);
    for (std::size_t axis = 0; axis < 3; ++axis) area.moment[axis].low = area.height_sum * pose.translation[static_cast<int>(axis)];
    out.areas.push_back(area);
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return true; }
  std::string name() const override { return "cpu"; }
  std::string device() const override { return "half-space"; }
  std::uint64_t memory_bytes() const override { return 0; }

  std::function<Result<void>(int)> on_query;   ///< called with the number of the query, from 1
  int queries = 0;
};

}  // namespace palpate
