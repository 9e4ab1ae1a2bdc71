#include "driver/path.h"

#include <algorithm>
#include <cstddef>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

Quat turned(const Quat& from, const Vec3& vector) { return glm::normalize(rotation_by(vector) * from); }

/// World rotation vector that takes `from` to `to` the short way.
Vec3 between(const Quat& from, const Quat& to) { return rotation_vector(to * glm::conjugate(from)); }

}  // namespace

PathPoint path_at(const std::vector<PathPoint>& path, double time_s) {
  const auto after =
      std::upper_bound(path.begin(), path.end(), time_s,
                       [](double time, const PathPoint& point) { return time < point.time_s; });
  if (after == path.begin()) return path.front();
  const PathPoint& a = *(after - 1);
  if (after == path.end()) return a;
  const PathPoint& b = *after;
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  PathPoint out = a;
  out.time_s = time_s;
  out.travel_m = a.travel_m + share * (b.travel_m - a.travel_m);
  out.pose.position = a.pose.position + share * (b.pose.position - a.pose.position);
  out.pose.rotation = turned(a.pose.rotation, share * between(a.pose.rotation, b.pose.rotation));
  return out;
}

GuideState guide_at(const std::vector<GuidePoint>& guide, double travel_m) {
  const double travel = std::clamp(travel_m, guide.front().travel_m, guide.back().travel_m);
  const auto after =
      std::upper_bound(guide.begin() + 1, guide.end() - 1, travel,
                       [](double value, const GuidePoint& point) { return value < point.travel_m; });
  const GuidePoint& a = *(after - 1);
  const GuidePoint& b = *after;
  const double length = b.travel_m - a.travel_m;
  const double share = (travel - a.travel_m) / length;
  const Vec3 turn = between(a.frame.rotation, b.frame.rotation);
  GuideState out;
  out.frame.position = a.frame.position + share * (b.frame.position - a.frame.position);
  out.frame.rotation = turned(a.frame.rotation, share * turn);
  out.tangent = (b.frame.position - a.frame.position) / length;
  out.turning = turn / length;
  return out;
}

}  // namespace palpate
