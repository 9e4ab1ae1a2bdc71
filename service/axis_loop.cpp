#include "service/axis_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "driver/mass_spring.h"

namespace palpate {
namespace {

constexpr double kTick = 1e-3;   // s

/// splitmix64 (Steele, Lea, Flood 2014): a number for every (seed, query), the same everywhere.
std::uint64_t scrambled(std::uint64_t seed, std::uint64_t query) {
  std::uint64_t z = seed * 0x9E3779B97F4A7C15u + (query + 1) * 0xD1B54A32D192ED03u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

double rounded(double value, double step) { return step > 0 ? step * std::round(value / step) : value; }

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();
  void add(double x) { least = std::min(least, x), most = std::max(most, x); }
  double width() const { return most > least ? most - least : 0; }
};

}  // namespace

int Delivery::duration(std::uint64_t query) const {
  switch (kind) {
    case Kind::kFixed:
    case Kind::kLost:
      return delay;
    case Kind::kRandom:
      return 1 + static_cast<int>(scrambled(seed, query) % static_cast<std::uint64_t>(std::max(2 * delay - 1, 1)));
    case Kind::kBursty:
      return query % 8 == 7 ? 4 * delay : delay;
  }
  return delay;
}

bool Delivery::lost(std::uint64_t query) const { return kind == Kind::kLost && scrambled(seed, query) % 4 == 0; }

AxisLoop::Outcome AxisLoop::run(int ticks) const {
  Outcome out;
  out.least_force_n = std::numeric_limits<double>::infinity();
  ForceLawState state(law);
  const MassSpring motion(mass_kg, damping + hand_damping, hand_stiffness, kTick);
  std::array<double, 64> on_its_way{};
  double x = start_x, speed = start_speed, felt = 0, work = 0;
  Range second, last;
  LawResult pending, arrived;
  std::int64_t due = 0;            // tick at which the query under way ends
  std::uint64_t query = 0;
  bool asked = false;
  for (int i = 0; i < ticks; ++i) {
    Pose pose = at_rest;
    const double seen = rounded(x, encoder_step_m);
    pose.position += seen * axis;
    const auto ask = [&] {
      pending = {};
      contact(seen, pose, pending);
      pending.tick = i;
      pending.gc = pose.position;
      pending.rotation = pose.rotation;
      due = i + delivery.duration(query);
      asked = true;
    };
    const LawResult* fresh = nullptr;
    const auto deliver = [&] {
      if (!delivery.lost(query)) arrived = pending, fresh = &arrived;
      ++query;
      asked = false;
    };
    if (asked && i >= due) deliver();
    if (!asked) ask();
    if (due == i) deliver();       // no delay at all

    double force = glm::dot(state.step({i, pose.position, pose.rotation}, fresh).force, axis);
    if (i < settle_ticks) {
      LawResult now;
      contact(x, pose, now);
      force = glm::dot(now.wrench.force, axis);
    }
    force = rounded(force, force_step_n);
    const std::size_t slot = static_cast<std::size_t>(i) % on_its_way.size();
    on_its_way[slot] = force;
    const double acts = device_delay == 0 ? force : i < device_delay ? 0 : on_its_way[(slot + on_its_way.size() - static_cast<std::size_t>(device_delay)) % on_its_way.size()];
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
  return outcome.finite && !outcome.ran_away && (outcome.late < 0.95 * outcome.early || outcome.late < least_m);
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

std::function<void(double, const Pose&, LawResult&)> linear_wall(double stiffness, double depth, std::uint32_t areas, double ratio, bool pushes_only) {
  return [=](double x, const Pose&, LawResult& out) {
    const double force = stiffness * (depth - x);
    if (pushes_only && !(force > 0)) return;
    out.contact = true;
    out.wrench.force = Vec3(force, 0, 0);
    out.areas = out.plane_count = std::min(areas, kMaxLawPlanes);
    for (std::uint32_t i = 0; i < out.plane_count; ++i)
      out.planes[i] = {.normal = Vec3(1, 0, 0), .lever = Vec3(0, 0.02 * i, 0), .force = force / out.plane_count, .stiffness = ratio * stiffness / out.plane_count};
  };
}

}  // namespace palpate
