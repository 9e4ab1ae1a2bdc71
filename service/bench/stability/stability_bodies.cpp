#include "service/bench/stability/stability_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "model/lattice/rotation.h"

namespace palpate {
namespace {

constexpr double kLow = 10, kHigh = 1e5;  // N/m: where K is looked for
constexpr int kQueryTicks = 2000;         // of a run over the real query

DeviceSettings bare(double mass_kg = 0.5, double inertia_kg_m2 = 2e-3) {
  DeviceSettings device;
  device.mass_kg = mass_kg;
  device.inertia_kg_m2 = inertia_kg_m2;
  // A spring so weak that it only keeps from drifting what no wall holds.
  device.hand_stiffness_n_per_m = 20, device.hand_angular_stiffness_nm = 0.1;
  device.hand_damping_n_s_per_m = device.hand_mass_kg = device.hand_angular_damping_nm_s = 0;
  return device;
}

std::vector<Pad> plate(double half = 0.02) {
  std::vector<Pad> pads;
  for (const double x : {-half, half})
    for (const double y : {-half, half}) pads.push_back({Vec3(x, y, -0.01), Vec3(0, 0, 1)});
  return pads;
}

/// Three walls at right angles, met beside gc.
std::vector<Pad> corner() {
  return {{Vec3(-0.02, 0.005, 0.01), Vec3(1, 0, 0)},
          {Vec3(0.005, -0.02, -0.01), Vec3(0, 1, 0)},
          {Vec3(-0.01, 0.015, -0.02), Vec3(0, 0, 1)}};
}

/// A peg whose hole holds it at two heights on four sides.
std::vector<Pad> peg() {
  std::vector<Pad> pads;
  for (const double z : {-0.03, 0.01})
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
      pads.push_back({Vec3(0, 0, z) - 0.01 * side, side});
  return pads;
}

}  // namespace

std::vector<BodyCase> body_cases() {
  DeviceSettings held;  // by the hand of docs/DEVICES.md
  DeviceSettings forces = bare(), torques = bare(), rig = bare();
  forces.actuated = {true, true, true, false, false, false};
  torques.actuated = {false, false, false, true, true, true};
  rig.actuated = {true, false, false, true, true, true};
  rig.guide = {{-1, {Vec3(-1, 0, 0), Quat(1, 0, 0, 0)}}, {1, {Vec3(1, 0, 0), Quat(1, 0, 0, 0)}}};
  return {{"plate", bare(), plate()},
          {"plate, light", bare(0.05, 2e-4), plate()},
          {"plate, heavy", bare(2, 8e-3), plate()},
          {"plate, held by a hand", held, plate()},
          {"plate, forces alone", forces, plate()},
          {"corner", bare(), corner()},
          {"peg in hole", bare(), peg()},
          {"peg, torques alone", torques, peg()},
          {"end of a lever of 200 mm", bare(), {{Vec3(0.2, 0, 0), Vec3(0, 0, 1)}}},
          {"rig, one force and three torques", rig, corner()}};
}

BodyLoop body_loop(const SimulatedMaker& make, const BodyCase& what, LawKind law, int delay, double stiffness,
                   bool bounces, const CouplingSettings& coupling) {
  BodyLoop loop;
  loop.make_device = make;
  loop.device = what.device;
  loop.coupling = coupling;
  loop.delivery.delay = delay;
  loop.law = {
      .kind = law, .stiffness_n_per_m = stiffness, .transitions = std::max(delay, 1), .change_n_per_s = 100};
  if (bounces) {
    loop.contact = pads_contact(what.pads, stiffness, 0, Pose{}, true);
    loop.at_rest = {Vec3(0, 0, 1e-3), rotation_by(Vec3(0.02, 0, 0))};
    loop.load.force = Vec3(0, 0, -1);
    loop.kick = {};
    loop.settle_ticks = 0;
    loop.reach_m = 0.1 + 4 / stiffness;
  } else {
    constexpr double kDeep =
        1e-4;  // m; what leaves it by half of that after a kick of some µm has no place in a stable run
    loop.contact = pads_contact(what.pads, stiffness, stiffness * kDeep, Pose{}, false);
    const Wrench held_up = pads_load(what.pads, stiffness * kDeep);
    loop.load = {-held_up.force, -held_up.torque};
    if (coupling.stiffness_n_per_m > 0) {
      loop.at_rest.position -= held_up.force / coupling.stiffness_n_per_m;
      loop.settle_ticks = 1000;  // what it is pressed with comes in at 100 N/s
    }
    loop.reach_m = kDeep / 2;
  }
  return loop;
}

double highest_stable_body(const SimulatedMaker& make, const BodyCase& what, LawKind law, int delay,
                           bool bounces, const CouplingSettings& coupling) {
  return highest_stable(kLow, kHigh, [&](double k) {
    const int ticks =
        std::max(20000, static_cast<int>(40000 * what.device.mass_kg));  // heavy things sway for longer
    return AxisLoop::stable(body_loop(make, what, law, delay, k, bounces, coupling).run(ticks),
                            bounces ? 1e-6 : 1e-11);
  });
}

DeviceSettings bare_device() {
  DeviceSettings device = bare();
  device.hand_angular_stiffness_nm = 5;  // or what is pressed on a corner topples, whatever the law
  return device;
}

Result<bool> stable_body_query(const SimulatedMaker& make, const ContactCase& what, PreparedCase& prepared,
                               const DeviceSettings& device, LawKind law, int delay, double stiffness,
                               const std::function<bool()>& stopped) {
  const Pose start = what.pose(0);
  const Vec3 gc_tool = prepared.geometry().tool_gc_m;
  Result<void> failed;
  prepared.begin(stiffness);
  const bool coupled = law == LawKind::kCorrected && prepared.spring().on();
  BodyLoop loop;
  loop.make_device = make;
  loop.device = device;
  loop.delivery.delay = delay;
  loop.law = {
      .kind = law, .stiffness_n_per_m = stiffness, .transitions = std::max(delay, 1), .change_n_per_s = 100};
  if (coupled) loop.coupling = prepared.spring();
  loop.at_rest = {start.position + start.rotation * gc_tool, start.rotation};
  loop.contact = [&](const Pose& gc, LawResult& out) {
    const Pose tool{gc.position - gc.rotation * gc_tool, gc.rotation};
    if (failed && stopped && stopped()) failed = Error{ErrorCode::kInternal, "interrupted"};
    if (failed) failed = prepared.ask(tool, out);
    if (!failed || coupled || !out.field) return;
    const Result<Felt> felt = prepared.feel(tool);
    if (!felt)
      failed = felt.error();
    else
      out.wrench = felt->wrench;
  };
  LawResult rest;
  if (failed = prepared.ask(start, rest); !failed) return failed.error();
  Wrench load = rest.wrench;
  if (rest.field) {
    const Result<Felt> felt = prepared.feel(start);
    if (!felt) return felt.error();
    load = felt->wrench;
  }
  loop.load = {-load.force, -load.torque};
  // About 50 µm: far above a row of samples' own step, far below the depth.
  const double blow = 5e-5 * std::sqrt(stiffness * (device.mass_kg + device.hand_mass_kg)) / 1e-3;
  loop.kick = {blow * what.kick, 0.02 * blow * what.twist};
  loop.settle_ticks = 200;
  loop.reach_m = 2e-3;
  const bool stable = AxisLoop::stable(loop.run(kQueryTicks), 2e-5);
  if (!failed) return failed.error();
  return stable;
}

Result<double> highest_stable_body_query(const SimulatedMaker& make, const ContactCase& what,
                                         PreparedCase& prepared, const DeviceSettings& device, LawKind law,
                                         int delay, const std::function<bool()>& stopped) {
  Result<void> failed;
  const double found = highest_stable(200, 20000, [&](double k) {
    const Result<bool> stable = stable_body_query(make, what, prepared, device, law, delay, k, stopped);
    if (!stable) failed = stable.error();
    return stable && *stable;
  });
  if (!failed) return failed.error();
  return found;
}

}  // namespace palpate
