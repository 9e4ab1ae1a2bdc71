#pragma once
#include "model/lattice/lattice.h"
#include "model/lattice/vector.h"
#include "model/result.h"

namespace palpate {

/// World from tool: p_world = rotation · p_tool + position.
struct Pose {
  Vec3 position{0};           ///< m
  Quat rotation{1, 0, 0, 0};  ///< unit
};

/// Force and torque exerted by the scene on the tool, world frame.
struct Wrench {
  Vec3 force{0};   ///< N
  Vec3 torque{0};  ///< N·m, about the tool's centre of mass gc
};

/// Largest | |q|² − 1 | that still counts as a unit quaternion (chosen: a quaternion printed with 4 digits
/// passes).
inline constexpr double kUnitQuaternionTolerance = 1e-3;

struct SceneGeometry;

/// Rounds a pose to the lattice. Never uses sin or cos; the quaternion is normalised first.
/// Error (kBadValue): not finite, or not a unit rotation. Beyond the lattice is no error: see LatticePose.
Result<LatticePose> to_lattice(const Pose& pose, const SceneGeometry& geometry);

}  // namespace palpate
