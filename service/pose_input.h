#pragma once
#include <string>
#include <vector>

#include "model/pose.h"
#include "model/result.h"
#include "model/scene_geometry.h"

namespace palpate {

/// A pose as it was given and as it is judged.
struct InputPose {
  Pose pose;            ///< world from tool, m
  LatticePose lattice;
};

/// Reads `--pose "x y z qx qy qz qw"`: metres and a unit quaternion, between blanks or commas.
/// Errors (kBadValue): not seven numbers, not finite, not a unit rotation.
Result<InputPose> parse_pose(const std::string& text, const SceneGeometry& geometry);

/// Reads `--poses FILE.csv`: the header `x,y,z,qx,qy,qz,qw` to the letter, then a pose a line; blank lines are passed over.
/// Error (kBadValue): one sentence with file, line and value of the first bad line, and how many there are.
Result<std::vector<InputPose>> read_poses(const std::string& path, const SceneGeometry& geometry);

}  // namespace palpate
