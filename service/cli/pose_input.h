#pragma once
#include <array>
#include <iosfwd>
#include <string>
#include <vector>

#include "model/lattice/pose.h"
#include "model/result.h"

namespace palpate {

/// Reads `--pose "x y z qx qy qz qw"`: metres and a unit quaternion, between blanks or commas; world from
/// tool. Errors (kBadValue): not seven numbers, not finite, not a unit rotation.
Result<Pose> parse_pose(const std::string& text);

/// Reads `--poses FILE.csv`: the header `x,y,z,qx,qy,qz,qw`, then a pose a line; or that of a scene's path or
/// a run's trace, `time_s,x_m,y_m,z_m,qx,qy,qz,qw` and further columns, of which the pose alone is used.
/// Blank lines are passed over. Error (kBadValue): one sentence with file, line and value of the first bad
/// line, and how many there are.
Result<std::vector<Pose>> read_poses(const std::string& path);

/// The same, and the path of a guided scene, whose poses lie along the guide that the scene file names.
/// Further errors: there is none, the scene's own.
Result<std::vector<Pose>> read_poses_of_scene(const std::string& path, const std::string& scene_file);

/// read_poses() from a stream that sentences call `name`.
Result<std::vector<Pose>> read_poses(std::istream& in, const std::string& name);

/// x y z qx qy qz qw as a pose. Error (kBadValue): a clause that says why it is none.
Result<Pose> pose_of(const std::array<double, 7>& values);

}  // namespace palpate
