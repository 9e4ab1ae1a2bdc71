// Parts that touch on several sides: what a method must balance. Prisms of equally many sides with flats
// along x, so that a move along x meets flat on flat and the closed form is that of the mesh itself.
#include <algorithm>
#include <cmath>

#include "bench/haptic/case.h"
#include "bench/haptic/solids.h"

namespace yardstick {
namespace {

constexpr double kPi = 3.14159265358979323846, kMm = 1e-3;
constexpr double kPeg = 10 * kMm, kHole = 30 * kMm;  // the peg's radius; how deep the hole is
constexpr std::uint32_t kSides = 96;

Case peg_in_bore(const std::string& name, double play) {
  Case out;
  out.name = name;
  out.group = "fit";
  out.fixed = ring(kPeg + play, 3 * kPeg, kHole, kSides);
  out.tool = cylinder(kPeg, 2 * kHole, kSides);
  finish(out);
  return out;
}

/// count poses round the bore, `off` from its middle.
std::vector<Pose> round_the_bore(double off, std::size_t count) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * kPi * static_cast<double>(i) / static_cast<double>(count - 1);
    out.push_back({Vec3(off * std::cos(angle), off * std::sin(angle), 0)});
  }
  return out;
}

/// The tilt from which on parts touch, rad: where `excess`, which grows with it, is 0.
double first_touch(const auto& excess) {
  double low = 0, high = 0.5;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (excess(middle) < 0 ? low : high) = middle;
  }
  return low;
}

Case peg_to_one_side(const Amount& amount) {
  const double play = 0.2 * kMm;
  Case out = peg_in_bore("peg with play, to one side", play);
  out.truth_from = "rigid peg: K (e − play) back to the middle, no torque; flats of both along the way";
  out.path = along({Pose{Vec3(play - 0.05 * kMm, 0, 0)}, Pose{Vec3(play + 0.5 * kMm, 0, 0)}}, amount.path);
  for (const Pose& pose : out.path) {
    const double push = out.stiffness * std::max(0.0, pose.position.x - play);
    out.truths.push_back({Vec3(-push, 0, 0), Vec3(0), {}, push});
  }
  out.rest = Pose{Vec3(play + 0.25 * kMm, 0, 0)};
  out.loop = round_the_bore(out.rest.position.x, amount.loop);
  return out;
}

Case peg_tilted(const Amount& amount) {
  const double play = 0.2 * kMm, half = kHole / 2;
  Case out = peg_in_bore("peg with play, tilted", play);
  out.truth_from = "rigid peg between two rims: no force, Kρ² (θ − θ₀) rights it, R cos θ₀ − h sin θ₀ = r";
  const double first =
      first_touch([&](double a) { return kPeg - (kPeg + play) * std::cos(a) + half * std::sin(a); });
  const auto place = [](double angle) { return Pose{Vec3(0), turn_by(Vec3(0, angle, 0))}; };
  out.path = along({place(first - 0.003), place(first + 0.03)}, amount.path);
  for (const Pose& pose : out.path) {
    const double angle = turn_between(Quat(1, 0, 0, 0), pose.rotation).y;
    const double push = out.stiffness * out.gyration * std::max(0.0, angle - first);
    out.truths.push_back({Vec3(0), Vec3(0, -push * out.gyration, 0), {}, push});
  }
  out.rest = place(first + 0.015);
  for (std::size_t i = 0; i < amount.loop; ++i) {  // the tilt's axis goes round
    const double round = 2 * kPi * static_cast<double>(i) / static_cast<double>(amount.loop - 1);
    out.loop.push_back({Vec3(0), turn_by((first + 0.015) * Vec3(std::sin(round), std::cos(round), 0))});
  }
  return out;
}

Case press_fit(const Amount& amount) {
  const double over = 0.1 * kMm;
  Case out = peg_in_bore("press fit, off its middle", -over);
  out.truth_from = "two walls press: towards the middle by symmetry; how much is the material's";
  out.path = along({Pose{}, Pose{Vec3(over, 0, 0)}}, amount.path);
  const double scale = out.stiffness * over;
  for (std::size_t i = 0; i < out.path.size(); ++i)
    out.truths.push_back(i == 0 ? Truth{Vec3(0), Vec3(0), {}, scale}
                                : Truth{{}, Vec3(0), Vec3(-1, 0, 0), scale});
  out.rest = Pose{};
  out.loop = round_the_bore(over, amount.loop);
  return out;
}

Case key_yawed(const Amount& amount) {
  const double half_length = 20 * kMm, half_width = 4 * kMm, play = 0.1 * kMm;
  Case out;
  out.name = "key, yawed in its keyway";
  out.group = "fit";
  out.truth_from = "rigid key between two walls: no force, Kρ² (θ − θ₀) rights it, w cos θ₀ + a sin θ₀ = W";
  const double wall = half_width + play;
  out.fixed = box(Vec3(-0.03, wall, -0.01), Vec3(0.03, 0.02, 0.01));
  append(out.fixed, box(Vec3(-0.03, -0.02, -0.01), Vec3(0.03, -wall, 0.01)));
  out.tool = box(Vec3(-half_length, -half_width, -0.015), Vec3(half_length, half_width, 0.015));
  finish(out);
  const double first =
      first_touch([&](double a) { return half_width * std::cos(a) + half_length * std::sin(a) - wall; });
  const auto place = [](double angle) { return Pose{Vec3(0), turn_by(Vec3(0, 0, angle))}; };
  out.path = along({place(first - 0.002), place(first + 0.02)}, amount.path);
  for (const Pose& pose : out.path) {
    const double angle = turn_between(Quat(1, 0, 0, 0), pose.rotation).z;
    const double push = out.stiffness * out.gyration * std::max(0.0, angle - first);
    out.truths.push_back({Vec3(0), Vec3(0, 0, -push * out.gyration), {}, push});
  }
  out.rest = place(first + 0.01);
  const Pose aside = moved(out.rest, Vec3(0, 0.2 * kMm, 0), Vec3(0));
  out.loop = along({out.rest, aside, Pose{aside.position}, Pose{}, out.rest}, amount.loop);
  return out;
}

}  // namespace

std::vector<Case> fits(const Amount& amount) {
  return {peg_to_one_side(amount), peg_tilted(amount), press_fit(amount), key_yawed(amount)};
}

}  // namespace yardstick
