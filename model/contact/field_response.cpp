#include "model/contact/field_response.h"

#include <algorithm>
#include <cmath>

#include "model/lattice/wide_sum.h"

namespace palpate {
namespace {

constexpr double kQ20 = 1048576.0;

Vec3 to_vector(const std::array<WideSum, 3>& sums) {
  return Vec3(to_double(sums[0]), to_double(sums[1]), to_double(sums[2]));
}

/// What a sample's φ w of one is worth, N: k' · step · spacing².
double newton(const SceneGeometry& geometry, double stiffness) {
  const double step = geometry.lattice.step_m, side = step * geometry.sample_spacing;
  return field_modulus(geometry, stiffness) * step * side * side;
}

Vec3 origin_of(const LatticePose& pose, const SceneGeometry& geometry) {
  return geometry.lattice.origin_m + geometry.lattice.step_m * Vec3(pose.translation);
}

/// Force of a bin, and its torque about gc.
Wrench wrench_of(const FieldBin& bin, const SceneGeometry& geometry, double newtons, const Vec3& origin,
                 const Vec3& gc) {
  Wrench out;
  out.force = (newtons / kQ30) * to_vector(bin.push);
  out.torque = newtons * geometry.lattice.step_m * to_vector(bin.turn) + glm::cross(origin - gc, out.force);
  return out;
}

/// Main axes of a symmetric 2×2 matrix [[a, b], [b, c]]: larger and smaller eigenvalue, and the first one's
/// direction.
struct Axes {
  double large, small, x, y;
};
Axes main_axes(double a, double b, double c) {
  const double mean = (a + c) / 2, half = (a - c) / 2, radius = std::sqrt(half * half + b * b);
  Axes out{mean + radius, mean - radius, 1, 0};
  // The longer of the two ways to write the eigenvector.
  const double x = radius + std::fabs(half), y = b;
  const double size = std::sqrt(x * x + y * y);
  if (size > 0) {
    out.x = (half >= 0 ? x : y) / size;
    out.y = (half >= 0 ? y : x) / size;
  }
  return out;
}

}  // namespace

Wrench field_wrench(const FieldSums& field, const LatticePose& pose, const SceneGeometry& geometry,
                    double stiffness, const Vec3& gc) {
  const double newtons = newton(geometry, stiffness);
  const Vec3 origin = origin_of(pose, geometry);
  Wrench sum;
  for (const FieldBin& bin : field.bins) {
    if (bin.samples == 0) continue;
    const Wrench one = wrench_of(bin, geometry, newtons, origin, gc);
    sum.force += one.force;
    sum.torque += one.torque;
  }
  return sum;
}

void field_planes(const FieldSums& field, const LatticePose& pose, const SceneGeometry& geometry,
                  double stiffness, const Vec3& gc, std::vector<ContactPlane>& planes) {
  planes.clear();
  const double newtons = newton(geometry, stiffness), step = geometry.lattice.step_m;
  const double lever = step * std::ldexp(1.0, lever_shift(geometry.tool_radius));  // m of one in give_at
  const Vec3 origin = origin_of(pose, geometry);
  for (const FieldBin& bin : field.bins) {
    if (bin.samples == 0) continue;
    const Wrench wrench = wrench_of(bin, geometry, newtons, origin, gc);
    const double force = std::sqrt(glm::dot(wrench.force, wrench.force));
    if (!(force > 0)) continue;
    const Vec3 n = wrench.force / force;
    const double give = static_cast<double>(bin.give), kappa = newtons / step * give / kQ20;
    ContactPlane plane{.normal = n, .lever = wrench.torque / force, .force = force, .stiffness = kappa};
    if (!(give > 0)) {
      planes.push_back(plane);
      continue;
    }

    // Where the surface gives way, and how far that spreads across the push.
    const auto mean = [&](std::size_t k) { return static_cast<double>(bin.give_at[k]) / give; };
    const auto spread = [&](std::size_t i, std::size_t k, std::size_t l) {
      return 256 * static_cast<double>(bin.give_spread[i]) / give - mean(k) * mean(l);
    };
    const Vec3 centre = origin + lever * Vec3(mean(0), mean(1), mean(2));
    const double xx = spread(0, 0, 0), yy = spread(1, 1, 1), zz = spread(2, 2, 2), xy = spread(3, 0, 1),
                 yz = spread(4, 1, 2), zx = spread(5, 2, 0);
    const Vec3 side = std::fabs(n.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 e = glm::normalize(glm::cross(n, side)), f = glm::cross(n, e);
    const auto along = [&](const Vec3& a, const Vec3& b) {
      return lever * lever *
             (a.x * b.x * xx + a.y * b.y * yy + a.z * b.z * zz + (a.x * b.y + a.y * b.x) * xy +
              (a.y * b.z + a.z * b.y) * yz + (a.z * b.x + a.x * b.z) * zx);
    };
    const Axes axes = main_axes(along(e, e), along(e, f), along(f, f));
    const Vec3 first = axes.x * e + axes.y * f, second = glm::cross(n, first);
    // Where the force acts, seen from there.
    const Vec3 about_centre = wrench.torque - glm::cross(centre - gc, wrench.force);
    const Vec3 away = glm::cross(n, about_centre) / force;

    Vec3 left = about_centre;  // torque that the planes' places don't explain
    const std::size_t begin = planes.size();
    constexpr double kLeastSpread = 1e-6;  // m: nearer than that two planes are one (chosen)
    const double reach_1 = std::sqrt(2 * std::max(axes.large, 0.0)),
                 reach_2 = std::sqrt(2 * std::max(axes.small, 0.0));
    if (reach_1 < kLeastSpread) {
      plane.lever = glm::cross(centre - gc, n) + left / force;
      planes.push_back(plane);
      continue;
    }
    const bool wide = reach_2 >= kLeastSpread;
    const double share = wide ? 0.25 : 0.5;
    const auto pair = [&](const Vec3& axis, double reach) {
      const double place = std::clamp(glm::dot(away, axis) / (2 * reach), -share, share);
      for (const double sign : {1.0, -1.0}) {
        plane.lever = glm::cross(centre + sign * reach * axis - gc, n);
        plane.force = force * (share + sign * place);
        plane.stiffness = kappa * share;
        left -= glm::cross(sign * reach * axis, plane.force * n);
        planes.push_back(plane);
      }
    };
    // Two planes on one axis stand at one standard deviation, four at √2 of them.
    pair(first, wide ? reach_1 : reach_1 / std::sqrt(2.0));
    if (wide) pair(second, reach_2);
    for (std::size_t i = begin; i < planes.size(); ++i) planes[i].lever += left / force;
  }
}

}  // namespace palpate
