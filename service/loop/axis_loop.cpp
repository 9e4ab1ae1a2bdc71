#include "service/loop/axis_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "driver/haptic_device.h"
#include "driver/mass_spring.h"

namespace palpate {
namespace {

double rounded(double value, double step) { return step > 0 ? step * std::round(value / step) : value; }

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  void add(double x) { least = std::min(least, x), most = std::max(most, x); }
  double width() const { return most > least ? most - least : 0; }
};

}  // namespace

AxisLoop::Outcome AxisLoop::run(int ticks) const {
  Outcome out;
  out.least_force_n = std::numeric_limits<double>::infinity();
  ForceLawState state(law);
  const MassSpring motion(mass_kg, damping + hand_damping, hand_stiffness, kTickSeconds);
  std::array<double, 64> on_its_way{};
  double x = start_x, speed = start_speed, felt = 0, work = 0;
  Range second, last;
  Courier courier(delivery);
  for (int i = 0; i < ticks; ++i) {
    Pose pose = at_rest;
    const double seen = rounded(x, encoder_step_m);
    pose.position += seen * axis;
    const LawResult* fresh = courier.at(i, pose, [&](LawResult& result) { contact(seen, pose, result); });

    double force = glm::dot(state.step({i, pose.position, pose.rotation}, fresh).force, axis);
    if (i < settle_ticks) {
      LawResult now;
      contact(x, pose, now);
      force = glm::dot(now.wrench.force, axis);
    }
    force = rounded(force, force_step_n);
    const std::size_t slot = static_cast<std::size_t>(i) % on_its_way.size();
    on_its_way[slot] = force;
    const double acts = device_delay == 0 ? force
                        : i < device_delay
                            ? 0
                            : on_its_way[(slot + on_its_way.size() - static_cast<std::size_t>(device_delay)) %
                                         on_its_way.size()];
    if (i > settle_ticks) {
      out.largest_step_n = std::max(out.largest_step_n, std::abs(acts - felt));
      out.least_force_n = std::min(out.least_force_n, acts);
      out.largest_force_n = std::max(out.largest_force_n, acts);
    }
    felt = acts;

    const double before = x;
    motion.step(x, speed, acts + load_n);
    work += acts * (x - before);
    out.energy_out_j = std::max(out.energy_out_j, work);
    if (!std::isfinite(x)) out.finite = false;
    if (!(std::abs(x) < reach_m)) {
      out.ran_away = true;
      break;
    }
    if (i > ticks / 4 && i <= ticks / 2) second.add(x);
    if (i > ticks - ticks / 4) last.add(x);
  }
  out.early = second.width();
  out.late = last.width();
  return out;
}

bool AxisLoop::stable(const Outcome& outcome, double least_m) {
  return outcome.finite && !outcome.ran_away &&
         (outcome.late < 0.95 * outcome.early || outcome.late < least_m);
}

double highest_stable(double low, double high, const std::function<bool(double)>& stable) {
  if (!stable(low)) return low;
  if (stable(high)) return high;
  while (high / low > 1.005) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

std::function<void(double, const Pose&, LawResult&)> linear_wall(double stiffness, double depth,
                                                                 std::uint32_t areas, double ratio,
                                                                 bool pushes_only) {
  return [=](double x, const Pose&, LawResult& out) {
    const double force = stiffness * (depth - x);
    if (pushes_only && !(force > 0)) return;
    out.contact = true;
    out.wrench.force = Vec3(force, 0, 0);
    out.areas = out.plane_count = std::min(areas, kMaxLawPlanes);
    for (std::uint32_t i = 0; i < out.plane_count; ++i)
      out.planes[i] = {.normal = Vec3(1, 0, 0),
                       .lever = Vec3(0, 0.02 * i, 0),
                       .force = force / out.plane_count,
                       .stiffness = ratio * stiffness / out.plane_count};
  };
}

}  // namespace palpate
