#include "tests/equivalence/touching_poses.h"

#include <cmath>

#include "model/pose.h"

namespace palpate {
namespace {

std::uint32_t any_triangle(const LatticeMesh& mesh, std::mt19937_64& random) {
  std::uint32_t id = 0;
  do id = static_cast<std::uint32_t>(random() % mesh.triangles.size());
  while (mesh.collapsed(id));
  return id;
}

/// A lattice point near the triangle's surface.
Int3 point_on(const LatticeMesh& mesh, std::uint32_t id, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  double u = unit(random), v = unit(random);
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Vec3 a(mesh.corner(id, 0)), b(mesh.corner(id, 1)), c(mesh.corner(id, 2));
  return Int3(glm::round(a + u * (b - a) + v * (c - a)));
}

Quat any_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Quat q(normal(random), normal(random), normal(random), normal(random));
  return q * (1 / std::sqrt(glm::dot(q, q)));
}

/// Puts tool lattice point `v` at world lattice point `p`.
void bring(LatticePose& pose, const Int3& v, const Int3& p) {
  pose.translation = Int3(0);
  pose.translation = p - transform(pose, v);
}

}  // namespace

LatticePose random_touching_pose(const SceneGeometry& geometry, double reach, std::mt19937_64& random) {
  Pose rotation;
  rotation.rotation = any_rotation(random);
  // Only the rotation of this is used; the translation follows from the two points.
  LatticePose pose = to_lattice(rotation, geometry).value();
  pose.beyond_lattice = false;
  std::normal_distribution<double> offset(0, reach * geometry.mockup_grid.size);
  const Int3 tool_point = point_on(geometry.tool, any_triangle(geometry.tool, random), random);
  const Int3 mockup_point = point_on(geometry.mockup, any_triangle(geometry.mockup, random), random);
  bring(pose, tool_point, mockup_point + Int3(glm::round(Vec3(offset(random), offset(random), offset(random)))));
  return pose;
}

LatticePose aligned_touching_pose(const SceneGeometry& geometry, std::mt19937_64& random) {
  LatticePose pose;
  // A permutation of the axes with signs, turned into a rotation by the last sign.
  const int first = static_cast<int>(random() % 3), second = (first + 1 + static_cast<int>(random() % 2)) % 3;
  const int third = 3 - first - second;
  const std::int32_t one = 1 << 30, s0 = random() % 2 != 0 ? one : -one, s1 = random() % 2 != 0 ? one : -one;
  const bool even = (second - first + 3) % 3 == 1;
  pose.rotation_q30[0][first] = s0;
  pose.rotation_q30[1][second] = s1;
  pose.rotation_q30[2][third] = ((s0 > 0) == (s1 > 0)) == even ? one : -one;

  const std::uint32_t tool_id = any_triangle(geometry.tool, random), mockup_id = any_triangle(geometry.mockup, random);
  const Int3 v = geometry.tool.corner(tool_id, static_cast<int>(random() % 3));
  Int3 p = random() % 2 != 0 ? geometry.mockup.corner(mockup_id, static_cast<int>(random() % 3)) : point_on(geometry.mockup, mockup_id, random);
  if (random() % 4 == 0) p[static_cast<int>(random() % 3)] += static_cast<int>(random() % 3) - 1;
  if (random() % 4 == 0) p[static_cast<int>(random() % 3)] += geometry.mockup_grid.size / 2;
  bring(pose, v, p);
  return pose;
}

}  // namespace palpate
