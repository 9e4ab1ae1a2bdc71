#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/scene/scene.h"

namespace palpate {

/// Reads the hand's path, a CSV file with one of two headers:
///   free:    time_s,x_m,y_m,z_m,qx,qy,qz,qw,stage       world from tool
///   guided:  time_s,travel_m,rx_rad,ry_rad,rz_rad,stage  rotation vector relative to the guide's frame
/// Errors (kBadValue) name file, line, value and what is allowed: another header, a number that is missing or
/// not finite, times that do not ascend, a rotation that is not unit, a stage below 0, no point at all.
Result<std::vector<PathPoint>> read_path(const std::string& file, bool guided);

/// Which of the two headers a file begins with: true for guided; empty: neither, or it can't be read.
std::optional<bool> guided_header(const std::string& file);

/// Reads a guide: header travel_m,x_m,y_m,z_m,qx,qy,qz,qw, at least two points, travel ascending. Errors as
/// above.
Result<std::vector<GuidePoint>> read_guide(const std::string& file);

/// What read_path and read_guide read, numbers in the shortest form that reads back as the same double.
std::string path_text(const std::vector<PathPoint>& path, bool guided);
/// As path_text, of a guide: a line a point.
std::string guide_text(const std::vector<GuidePoint>& guide);

/// The frame at a travel: linear between points, held beyond the ends. `guide` is not empty.
Pose guide_frame(const std::vector<GuidePoint>& guide, double travel_m);

/// World from tool at a point of a path, through the guide unless that is empty.
Pose path_pose(const PathPoint& point, const std::vector<GuidePoint>& guide);

}  // namespace palpate
