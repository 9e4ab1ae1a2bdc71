#include "tests/equivalence/lattice_shapes.h"

#include <algorithm>
#include <cmath>

#include "model/lattice/lattice_build.h"
#include "model/mesh/patches.h"
#include "model/mesh/smooth_angle.h"

namespace palpate::equivalence {
namespace {

Mesh mesh_of(const Triangles& triangles, const std::vector<std::size_t>& parts) {
  Mesh mesh;
  for (const LatticeTriangle& t : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Int3& corner : {t.a, t.b, t.c}) mesh.vertices.emplace_back(corner);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  for (std::size_t p = 0; p < std::max<std::size_t>(parts.size(), 1); ++p) {
    const std::size_t begin = parts.empty() ? 0 : parts[p],
                      end = p + 1 < parts.size() ? parts[p + 1] : triangles.size();
    mesh.parts.push_back(
        {std::to_string(p), static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end - begin)});
  }
  return mesh;
}

}  // namespace

Result<SceneGeometry> lattice_scene(const Triangles& mockup, const Triangles& tool, std::int32_t voxel,
                                    std::int32_t spacing, const std::vector<std::size_t>& parts) {
  SceneGeometry scene;
  scene.lattice.step_m = 1;
  const auto angle = make_smooth_angle(30);
  if (!angle) return angle.error();
  scene.smooth_angle = *angle;
  auto mockup_mesh =
      build_lattice_mesh(mesh_of(mockup, parts), scene.lattice, scene.smooth_angle, scene.mockup_report);
  if (!mockup_mesh) return mockup_mesh.error();
  scene.mockup = std::move(*mockup_mesh);
  auto tool_mesh =
      build_lattice_mesh(mesh_of(tool, {}), scene.lattice, scene.smooth_angle, scene.tool_report);
  if (!tool_mesh) return tool_mesh.error();
  scene.tool = std::move(*tool_mesh);
  scene.mockup_surface = measure(scene.mockup);
  scene.tool_surface = measure(scene.tool);
  scene.mockup_grid = make_grid(scene.mockup.box_min, scene.mockup.box_max, voxel);
  scene.tool_grid = make_grid(scene.tool.box_min, scene.tool.box_max, voxel);
  scene.sample_spacing = spacing;
  scene.contact_samples = 12;  // few, so that many contacts are sampled coarsely
  weigh_for_field(scene.sample_spacing, find_tips(scene.sample_spacing, scene.mockup), scene.mockup);
  weigh_for_field(scene.sample_spacing, find_tips(scene.sample_spacing, scene.tool), scene.tool);
  count_grid_samples(scene.sample_spacing, scene.tool);
  scene.reference_area_m2 = 1;
  scene.tool_gyration_m = 1;
  double radius = 0;
  for (const Int3& v : scene.tool.vertices) radius = std::max(radius, std::sqrt(glm::dot(Vec3(v), Vec3(v))));
  scene.tool_radius = static_cast<std::int32_t>(std::ceil(radius)) + 3;
  return scene;
}

Triangles box_of(const Int3& min, const Int3& max) {
  Triangles out;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const auto corner = [&](bool high_u, bool high_v) {
        Int3 p(0);
        p[axis] = upper ? max[axis] : min[axis];
        p[u] = high_u ? max[u] : min[u];
        p[v] = high_v ? max[v] : min[v];
        return p;
      };
      const Int3 a = corner(false, false), b = corner(true, false), c = corner(true, true),
                 d = corner(false, true);
      if (upper)
        append(out, {{a, b, c}, {a, c, d}});
      else
        append(out, {{a, c, b}, {a, d, c}});
    }
  return out;
}

Triangles flipped(Triangles triangles) {
  for (LatticeTriangle& t : triangles) std::swap(t.b, t.c);
  return triangles;
}

void append(Triangles& into, const Triangles& more) { into.insert(into.end(), more.begin(), more.end()); }

}  // namespace palpate::equivalence
