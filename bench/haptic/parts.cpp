#include "bench/haptic/parts.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "bench/haptic/read_ply.h"

namespace yardstick {
namespace {

std::vector<Pose> read_poses(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("'" + file + "' can't be read");
  std::vector<Pose> out;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream values(line);
    Pose pose;
    Vec3& p = pose.position;
    Quat& q = pose.rotation;
    if (!(values >> p.x >> p.y >> p.z >> q.x >> q.y >> q.z >> q.w))
      throw std::runtime_error("'" + file + "': line " + std::to_string(out.size() + 2) +
                               " does not hold seven numbers");
    q = glm::normalize(q);
    out.push_back(pose);
  }
  if (out.size() < 2) throw std::runtime_error("'" + file + "' holds fewer than two poses");
  return out;
}

}  // namespace

Case part(const std::string& files, const Amount& amount) {
  const std::size_t equals = files.find('='), first = files.find(','), second = files.find(',', first + 1);
  if (equals == std::string::npos || first == std::string::npos || second == std::string::npos ||
      equals > first)
    throw std::runtime_error("'" + files + "' is not NAME=FIXED.ply,TOOL.ply,POSES.csv");
  Case out;
  out.name = files.substr(0, equals);
  out.group = "part";
  out.truth_from = "none: there is no closed form";
  out.fixed = read_ply(files.substr(equals + 1, first - equals - 1));
  out.tool = read_ply(files.substr(first + 1, second - first - 1));
  const Vec3 centre = centre_of_volume(out.tool);
  finish(out);
  std::vector<Pose> corners = read_poses(files.substr(second + 1));
  for (Pose& pose : corners) pose.position += pose.rotation * centre;
  out.path = along(corners, std::max(amount.path, corners.size()));
  out.rest = corners.front();
  const Vec3 x(0.2e-3, 0, 0), y(0, 0.2e-3, 0);
  const auto off = [&](const Vec3& by) { return moved(out.rest, by, Vec3(0)); };
  out.loop = along({out.rest, off(x), off(x + y), off(y), out.rest}, amount.loop);
  return out;
}

}  // namespace yardstick
