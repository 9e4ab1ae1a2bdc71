#include "tests/equivalence/touching_poses.h"

#include <glm/gtc/quaternion.hpp>

#include <cmath>

namespace palpate::equivalence {
namespace {

std::uint32_t any_triangle(const LatticeMesh& mesh, Random& random) {
  std::uint32_t id = 0;
  do id = static_cast<std::uint32_t>(random.below(mesh.triangles.size()));
  while (mesh.collapsed(id));
  return id;
}

/// A lattice point near the triangle's surface.
Int3 point_on(const LatticeMesh& mesh, std::uint32_t id, Random& random) {
  double u = random.unit(), v = random.unit();
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Vec3 a(mesh.corner(id, 0)), b(mesh.corner(id, 1)), c(mesh.corner(id, 2));
  return Int3(glm::round(a + u * (b - a) + v * (c - a)));
}

/// Even over all rotations: a point of the ball of four dimensions, pushed out to its surface.
Quat any_rotation(Random& random) {
  for (;;) {
    const double w = random.unit() * 2 - 1, x = random.unit() * 2 - 1, y = random.unit() * 2 - 1,
                 z = random.unit() * 2 - 1;
    const double square = w * w + x * x + y * y + z * z;
    if (square <= 1 && square > 0.01) return Quat(w, x, y, z) * (1 / std::sqrt(square));
  }
}

/// Puts tool lattice point `v` at world lattice point `p`.
void bring(LatticePose& pose, const Int3& v, const Int3& p) {
  pose.translation = Int3(0);
  pose.translation = p - transform(pose, v);
}

}  // namespace

LatticePose quarter_turns(Random& random) {
  LatticePose pose;
  // A permutation of the axes with signs, turned into a rotation by the last sign.
  const int first = random.between(0, 2), second = (first + random.between(1, 2)) % 3;
  const int third = 3 - first - second;
  const std::int32_t one = 1 << 30, s0 = random.below(2) != 0 ? one : -one,
                     s1 = random.below(2) != 0 ? one : -one;
  const bool even = (second - first + 3) % 3 == 1;
  pose.rotation_q30[0][first] = s0;
  pose.rotation_q30[1][second] = s1;
  pose.rotation_q30[2][third] = ((s0 > 0) == (s1 > 0)) == even ? one : -one;
  return pose;
}

LatticePose random_touching_pose(const SceneGeometry& geometry, double reach, Random& random) {
  Pose rotation;
  rotation.rotation = any_rotation(random);
  // Only the rotation of this is used; the translation follows from the two points.
  LatticePose pose = to_lattice(rotation, geometry).value();
  pose.beyond_lattice = false;
  const Int3 tool_point = point_on(geometry.tool, any_triangle(geometry.tool, random), random);
  Int3 mockup_point = point_on(geometry.mockup, any_triangle(geometry.mockup, random), random);
  for (int k = 0; k < 3; ++k)
    mockup_point[k] +=
        static_cast<std::int32_t>(std::nearbyint(random.bell() * reach * geometry.mockup_grid.size));
  bring(pose, tool_point, mockup_point);
  return pose;
}

LatticePose aligned_touching_pose(const SceneGeometry& geometry, Random& random) {
  LatticePose pose = quarter_turns(random);
  const std::uint32_t tool_id = any_triangle(geometry.tool, random),
                      mockup_id = any_triangle(geometry.mockup, random);
  const Int3 v = geometry.tool.corner(tool_id, random.between(0, 2));
  Int3 p = random.below(2) != 0 ? geometry.mockup.corner(mockup_id, random.between(0, 2))
                                : point_on(geometry.mockup, mockup_id, random);
  if (random.below(4) == 0) p[random.between(0, 2)] += random.between(-1, 1);
  if (random.below(4) == 0) p[random.between(0, 2)] += geometry.mockup_grid.size / 2;
  bring(pose, v, p);
  return pose;
}

LatticePose moved_on(const LatticePose& from, std::int32_t voxel, Random& random) {
  LatticePose pose = from;
  for (int k = 0; k < 3; ++k) pose.translation[k] += random.between(-(voxel / 2), voxel / 2);
  return pose;
}

Pose pose_of(const LatticePose& at, const SceneGeometry& geometry) {
  glm::dmat3 m;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) m[c][r] = at.rotation_q30[r][c] * 0x1p-30;
  const Quat q = glm::normalize(glm::quat_cast(m));
  return {
      geometry.lattice.origin_m + geometry.lattice.step_m * Vec3(at.translation) - q * geometry.tool_centre_m,
      q};
}

}  // namespace palpate::equivalence
