// Tools on a half space, modelled as a block whose top is the plane z = 0. The rigid tool is lifted until its
// deepest point lies in the plane: F = K d along z.
#include <cmath>

#include "bench/haptic/case.h"
#include "bench/haptic/on_plane.h"
#include "bench/haptic/solids.h"

namespace yardstick {
namespace {

constexpr double kMm = 1e-3;

/// Two balls that are one tool, the larger a lever's length from the centre: lifting it turns the tool.
/// Least spring energy ½K|u|² + ½Kρ²θ² with the ball's lowest point in the plane: with the lever (x, z) from
/// the tool's centre to the ball's, h(θ) = z cos θ − x sin θ its height over the centre, the plane's push λ
/// lifts by u = λ/K and turns by θ = λ h'(θ) / (Kρ²); θ follows from u + h(θ) − h(0) = d by bisection.
Case ball_on_an_arm(const Amount& amount) {
  const double radius = 10 * kMm;
  Case out;
  out.name = "ball on an arm";
  out.group = "closed form";
  out.truth_from = "rigid ball in a plane at the end of a lever; least energy of the springs, one equation";
  out.fixed = ground();
  out.tool = shifted(sphere(radius, 64), Vec3(-30, 0, 0) * kMm);
  append(out.tool, shifted(sphere(6 * kMm, 48), Vec3(30, 0, 20) * kMm));
  const Vec3 lever = Vec3(-30, 0, 0) * kMm - centre_of_volume(out.tool);
  finish(out);
  const double k = out.stiffness, turning = k * out.gyration * out.gyration;
  const auto place = [&](double depth) { return Pose{Vec3(0, 0, radius - lever.z - depth)}; };
  const auto rise = [&](double a) { return lever.z * std::cos(a) - lever.x * std::sin(a) - lever.z; };
  const auto slope = [&](double a) { return -lever.z * std::sin(a) - lever.x * std::cos(a); };
  out.path = along({place(-0.1 * kMm), place(1 * kMm)}, amount.path);
  for (const Pose& pose : out.path) {
    const double depth = radius - lever.z - pose.position.z;
    double low = 0, high = 0.2;
    for (int i = 0; i < 100; ++i) {
      const double a = (low + high) / 2;
      (turning * a / slope(a) / k + rise(a) < depth ? low : high) = a;
    }
    const double push = turning * low / slope(low);
    out.truths.push_back({Vec3(0, 0, push), Vec3(0, turning * low, 0), {}, push});
  }
  out.rest = place(0.5 * kMm);
  out.loop = over_the_edge(out.tool, out.rest, 5 * kMm, amount.loop);
  return out;
}

}  // namespace

std::vector<Case> closed_forms(const Amount& amount) {
  return {on_plane("ball in a plane", "closed form", sphere(20 * kMm, 96), 1 * kMm, amount),
          on_plane("box flat on a plane", "closed form",
                   box(Vec3(-20, -20, -10) * kMm, Vec3(20, 20, 10) * kMm), 1 * kMm, amount),
          on_plane("cone's tip in a plane", "closed form", cone(15 * kMm, 30 * kMm, 96), 2 * kMm, amount),
          ball_on_an_arm(amount)};
}

}  // namespace yardstick
