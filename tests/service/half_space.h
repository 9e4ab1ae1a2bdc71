#pragma once
#include <functional>
#include <stdexcept>

#include "model/collision_backend.h"
#include "model/scene/scene.h"

namespace palpate {

/// A scene without meshes: the tool is its own origin, a point; the mock-up is everything below z = 0.
inline LoadedScene half_space_scene() {
  LoadedScene scene;
  scene.scene.file = "half_space.json";
  scene.geometry.lattice.step_m = 1.0 / (1 << 20);
  scene.geometry.tool_radius = 2;
  scene.geometry.mockup_grid = {.origin = Int3(-(1 << 24)), .size = 1 << 20, .bricks = Int3(4)};  // ±16 m
  scene.scene.response.stiffness_n_per_m = 1000;
  scene.scene.control.fade_in_ms = 0;
  scene.scene.control.coupling_n_per_m = scene.scene.control.coupling_nm_per_rad =
      0;  // the wall's own stiffness, K
  // One sample a step wide: k' · φ · step² is K · depth.
  scene.geometry.sample_spacing = 1;
  scene.geometry.reference_area_m2 = scene.geometry.lattice.step_m * scene.geometry.lattice.step_m;
  scene.geometry.tool_gyration_m = 0.02;
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

/// Answers for the half-space as a back end would, for both profiles: one area and one sample, n = z, depth =
/// −z.
class HalfSpace : public CollisionBackend {
 public:
  Result<void> prepare(const SceneGeometry&, const Plan&, const Progress&) override { return {}; }
  Result<void> query(const LatticePose& pose, const Ignored*, Contacts& out) override {
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
    area.height_sum = depth * 4;  // d = |D|·step·height/rays = 2^28·h/2^30 steps
    area.max_height = static_cast<std::uint32_t>(depth * 4);
    area.voxel_count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
      area.voxel_sum[axis] = pose.translation[static_cast<int>(axis)];
    area.field = {.id = 0,
                  .samples = 1,
                  .max_depth = static_cast<std::uint32_t>(depth),
                  .weight_sum = std::int64_t{1} << 24,
                  .depth_sum = depth << 10,
                  .push = {},
                  .moment = {}};
    area.field.push[2] = {.low = (depth & 3) << 30, .high = depth >> 2};  // φ · 2^30
    FieldBin& up = out.field.bins[22];                                    // 0 0 1
    up.samples = 1;
    up.push[2] = {.low = (depth & 3) << 30, .high = depth >> 2};  // φ · 2^30
    up.give = 1 << 20;
    out.field.max_depth = static_cast<std::uint32_t>(depth);
    out.areas.push_back(area);
    return {};
  }
  Result<VoxelPartition> partition(bool) const override { return VoxelPartition{}; }
  bool has_internal_voxels() const override { return true; }
  std::string name() const override { return "cpu"; }
  std::string device() const override { return "half-space"; }
  std::uint64_t memory_bytes() const override { return 0; }

  std::function<Result<void>(int)> on_query;  ///< called with the number of the query, from 1
  int queries = 0;
};

}  // namespace palpate
