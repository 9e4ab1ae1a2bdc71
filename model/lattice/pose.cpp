#include "model/lattice/pose.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "model/scene/scene_geometry.h"

namespace palpate {
namespace {

/// Squared distance of a point to the grid's box, in steps²: |difference| < 2^31, so the sum stays below 2^64
/// / 1.3.
std::uint64_t squared_distance(const VoxelGrid& grid, const Long3& point) {
  std::uint64_t sum = 0;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t low = grid.origin[k],
                       high = low + std::int64_t{grid.size} * kBrickSide * grid.bricks[k];
    const std::int64_t away = std::max({low - point[k], point[k] - high, std::int64_t{0}});
    sum += static_cast<std::uint64_t>(away * away);
  }
  return sum;
}

}  // namespace

Result<LatticePose> to_lattice(const Pose& pose, const SceneGeometry& geometry) {
  const Vec3& p = pose.position;
  const Quat& q = pose.rotation;
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
    return bad_value(fmt::format("the pose's position ({}, {}, {}) is not finite", p.x, p.y, p.z));
  const double norm2 = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(std::abs(norm2 - 1) <= kUnitQuaternionTolerance))  // false for a NaN too
    return bad_value(fmt::format(
        "the pose's quaternion ({}, {}, {}, {}) is not a unit rotation: its squared length is {}, it may "
        "differ from 1 by {}",
        q.x, q.y, q.z, q.w, norm2, kUnitQuaternionTolerance));

  // The rotation matrix of q/|q|, by products alone: dividing each product of two components by |q|²
  // normalises.
  const double s = 2 / norm2;
  const double xx = s * (q.x * q.x), yy = s * (q.y * q.y), zz = s * (q.z * q.z), xy = s * (q.x * q.y),
               xz = s * (q.x * q.z), yz = s * (q.y * q.z), wx = s * (q.w * q.x), wy = s * (q.w * q.y),
               wz = s * (q.w * q.z);
  const double rotation[3][3] = {{1 - (yy + zz), xy - wz, xz + wy},
                                 {xy + wz, 1 - (xx + zz), yz - wx},
                                 {xz - wy, yz + wx, 1 - (xx + yy)}};

  LatticePose out;
  Vec3 translation;  // of the tool's lattice origin, steps
  const Vec3& c = geometry.tool_centre_m;
  for (int r = 0; r < 3; ++r) {
    for (int k = 0; k < 3; ++k)
      out.rotation_q30[r][k] =
          static_cast<std::int32_t>(std::nearbyint(std::clamp(rotation[r][k], -1.0, 1.0) * 0x1p30));
    // The unrounded matrix carries the centre, which may be far from the file's origin: the Q30 one would be
    // off by 2^-31 of that.
    const double centre = rotation[r][0] * c.x + rotation[r][1] * c.y + rotation[r][2] * c.z;
    translation[r] = std::nearbyint((p[r] + centre - geometry.lattice.origin_m[r]) / geometry.lattice.step_m);
  }

  // Free when the tool's sphere misses the grid's box. choose_lattice has left room for any centre that does
  // not: the grid, a radius for the centre, and a radius for the vertices, lie within kLatticeReach.
  Long3 centre;
  for (int k = 0; k < 3; ++k) {
    if (!(std::abs(translation[k]) <= kLatticeReach)) {
      out.beyond_lattice = true;
      return out;
    }
    centre[k] = static_cast<std::int64_t>(translation[k]);
  }
  const std::uint64_t radius = static_cast<std::uint64_t>(geometry.tool_radius);
  out.beyond_lattice = squared_distance(geometry.mockup_grid, centre) > radius * radius;
  // Beyond, distances may still be asked for, as far as vertices stay where predicates are exact.
  const auto within = [&](int k) {
    return centre[k] <= kLatticeReach - geometry.tool_radius &&
           -centre[k] <= kLatticeReach - geometry.tool_radius;
  };
  if (!out.beyond_lattice || (within(0) && within(1) && within(2))) out.translation = Int3(centre);
  return out;
}

}  // namespace palpate
