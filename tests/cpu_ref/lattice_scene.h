#pragma once
#include <initializer_list>
#include <stdexcept>
#include <vector>

#include "model/mesh/patches.h"
#include "model/scene/geometry_build.h"
#include "tests/cpu_ref/lattice_solids.h"

/// Scenes whose metres are lattice steps: what is written is what is judged.
namespace palpate::cpu_ref {

inline Mesh mesh_of(const std::vector<Triangle>& triangles) {
  Mesh mesh;
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) mesh.vertices.emplace_back(triangle[k]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  mesh.parts.push_back({"", 0, static_cast<std::uint32_t>(triangles.size())});
  return mesh;
}

/// Welded, oriented and with normals, as at load.
inline LatticeMesh lattice_mesh_of(const std::vector<Triangle>& triangles) {
  MeshReport report;
  Lattice lattice;
  lattice.step_m = 1;
  Result<LatticeMesh> mesh = build_lattice_mesh(mesh_of(triangles), lattice, SmoothAngle(), report);
  if (!mesh) throw std::runtime_error(mesh.error().sentence);
  Box box;
  for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t)
    if (!mesh->collapsed(t))
      for (int k = 0; k < 3; ++k) box.include(mesh->corner(t, k));
  mesh->box_min = box.min;
  mesh->box_max = box.max;
  return std::move(*mesh);
}

/// Mock-up and tool on the lattice, tool frame = world frame at the identity pose.
inline SceneGeometry scene_of(const std::vector<Triangle>& mockup, const std::vector<Triangle>& tool,
                              int voxel, int spacing) {
  SceneGeometry scene;
  scene.lattice.step_m = 1;
  scene.mockup = lattice_mesh_of(mockup);
  scene.tool = lattice_mesh_of(tool);
  scene.mockup_surface = measure(scene.mockup);
  scene.tool_surface = measure(scene.tool);
  scene.mockup_grid = make_grid(scene.mockup.box_min, scene.mockup.box_max, voxel);
  scene.tool_grid = make_grid(scene.tool.box_min, scene.tool.box_max, voxel);
  scene.sample_spacing = spacing;
  weigh_for_field(scene.sample_spacing, find_tips(scene.sample_spacing, scene.mockup), scene.mockup);
  weigh_for_field(scene.sample_spacing, find_tips(scene.sample_spacing, scene.tool), scene.tool);
  count_grid_samples(scene.sample_spacing, scene.tool);
  scene.reference_area_m2 = 1;
  scene.tool_gyration_m = 1;
  return scene;
}

inline LatticePose moved_by(const Int3& translation) {
  LatticePose pose;
  for (int k = 0; k < 3; ++k) pose.rotation_q30[k][k] = 1 << 30;
  pose.translation = translation;
  return pose;
}

inline std::vector<Triangle> together(std::initializer_list<std::vector<Triangle>> bodies) {
  std::vector<Triangle> all;
  for (const auto& body : bodies) all.insert(all.end(), body.begin(), body.end());
  return all;
}

/// A rectangle in the plane z = `height` cut into cells × cells × 2 triangles, facing +z.
inline std::vector<Triangle> lattice_plate(const Int3& min, const Int3& max, int cells) {
  std::vector<Triangle> result;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const auto at = [&](int a, int b) {
        return Int3(min.x + (max.x - min.x) / cells * a, min.y + (max.y - min.y) / cells * b, max.z);
      };
      result.emplace_back(at(i, j), at(i + 1, j), at(i + 1, j + 1));
      result.emplace_back(at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return result;
}

}  // namespace palpate::cpu_ref
