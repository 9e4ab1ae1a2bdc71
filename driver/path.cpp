#include "driver/path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

Quat turned(const Quat& from, const Vec3& vector) { return glm::normalize(rotation_by(vector) * from); }

/// World rotation vector that takes `from` to `to` the short way.
Vec3 between(const Quat& from, const Quat& to) { return rotation_vector(to * glm::conjugate(from)); }

/// Of a guide's frame: per travel.
struct Slope {
  Vec3 tangent, turning;
};

/// Between point `i` and the next.
Slope slope_of(const std::vector<GuidePoint>& guide, std::size_t i) {
  const GuidePoint &a = guide[i], &b = guide[i + 1];
  const double span = b.travel_m - a.travel_m;
  return {(b.frame.position - a.frame.position) / span, between(a.frame.rotation, b.frame.rotation) / span};
}

/// At point `i`: that of the parabola through it and its neighbours; at an end its only neighbour's.
Slope slope_at(const std::vector<GuidePoint>& guide, std::size_t i) {
  if (i == 0) return slope_of(guide, 0);
  if (i + 1 == guide.size()) return slope_of(guide, i - 1);
  const Slope before = slope_of(guide, i - 1), after = slope_of(guide, i);
  const double share =
      (guide[i].travel_m - guide[i - 1].travel_m) / (guide[i + 1].travel_m - guide[i - 1].travel_m);
  return {before.tangent + share * (after.tangent - before.tangent),
          before.turning + share * (after.turning - before.turning)};
}

/// From 0 at 0 to `end` at 1 with these rates there.
class Cubic {
 public:
  Cubic(const Vec3& end, const Vec3& rate_at_0, const Vec3& rate_at_1)
      : c1_(rate_at_0),
        c2_(3.0 * end - 2.0 * rate_at_0 - rate_at_1),
        c3_(rate_at_0 + rate_at_1 - 2.0 * end) {}
  Vec3 at(double t) const { return t * (c1_ + t * (c2_ + t * c3_)); }
  Vec3 rate(double t) const { return c1_ + t * (2.0 * c2_ + 3.0 * t * c3_); }

 private:
  Vec3 c1_, c2_, c3_;
};

// The angular velocity, world, of what a rotation vector v turns is w = v' + A v × v' + B v × (v × v'); the
// other way round v' = w − v × w / 2 + C v × (v × w) (left Jacobian of SO(3) and its inverse). Below this
// angle two terms of the factors' series are exact in double precision.
constexpr double kSmallAngle = 1e-3;

Vec3 turning_of(const Vec3& v, const Vec3& rate) {
  const double square = glm::dot(v, v), angle = std::sqrt(square);
  const bool small = angle < kSmallAngle;
  const double a = small ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
  const double b = small ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
  const Vec3 once = glm::cross(v, rate);
  return rate + a * once + b * glm::cross(v, once);
}

Vec3 vector_rate(const Vec3& v, const Vec3& turning) {
  const double square = glm::dot(v, v), half = 0.5 * std::sqrt(square);
  const double c = half < kSmallAngle ? 1.0 / 12 + square / 720 : (1 - half / std::tan(half)) / square;
  const Vec3 once = glm::cross(v, turning);
  return turning - 0.5 * once + c * glm::cross(v, once);
}

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
  const auto a = static_cast<std::size_t>(after - guide.begin()) - 1;
  const Pose& from = guide[a].frame;
  const Slope here = slope_of(guide, a), begin = slope_at(guide, a), end = slope_at(guide, a + 1);
  const double span = guide[a + 1].travel_m - guide[a].travel_m;
  const double t = (travel - guide[a].travel_m) / span;

  GuideState out;
  const Cubic along(span * here.tangent, span * begin.tangent, span * end.tangent);
  out.frame.position = from.position + along.at(t);
  out.tangent = along.rate(t) / span;

  // The same of the rotation vector since `from`: its rate at the other end is what turns by end.turning.
  const Vec3 whole = span * here.turning;
  const Cubic turn(whole, span * begin.turning, vector_rate(whole, span * end.turning));
  const Vec3 vector = turn.at(t);
  out.frame.rotation = turned(from.rotation, vector);
  out.turning = turning_of(vector, turn.rate(t)) / span;
  return out;
}

}  // namespace palpate
