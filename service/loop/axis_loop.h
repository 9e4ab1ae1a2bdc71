#pragma once
#include <cstdint>
#include <functional>

#include "service/loop/delivery.h"
#include "service/loop/force_law.h"

namespace palpate {

/// The yardstick of stability: a device held by a hand, free along one axis, against a contact, under a force
/// law, in virtual time.
///
/// Device and hand are one mass with damper and spring, integrated exactly for a force held over a tick
/// (driver/mass_spring.h: a matrix exponential; what is left is rounding, and stiff hands or light masses
/// cost nothing). The contact is whatever `contact` says: a formula, or a real collision query. Everything is
/// deterministic.
struct AxisLoop {
  double mass_kg = 0.5, damping = 1;            ///< kg, N·s/m
  double hand_stiffness = 0, hand_damping = 0;  ///< N/m, N·s/m: to where the hand is
  double encoder_step_m = 0, force_step_n = 0;  ///< what device and amplifier can resolve; 0: exact
  int device_delay = 0;                         ///< ticks from the law to the motor, at most 63
  Delivery delivery;
  ForceLawSettings law;
  Vec3 axis{1, 0, 0};  ///< unit; x is measured along it, m
  Pose at_rest;        ///< of the tool's centre of mass, at x = 0
  /// Fills wrench, contact and planes for the tool at `x`; the loop sets the pose and tick.
  std::function<void(double x, const Pose& pose, LawResult& out)> contact;
  double load_n = 0;                       ///< constant force along the axis: what the hand presses with
  double start_x = 1e-6, start_speed = 0;  ///< m, m/s
  int settle_ticks =
      200;  ///< before, the contact's force is there at once: the law's fade-in is no part of it

  struct Outcome {
    double early = 0, late = 0;  ///< largest − smallest x in the second and the last quarter, m
    double energy_out_j = 0;  ///< most work that the law's force had done on hand and device since the start
    double largest_step_n = 0;  ///< of the force along the axis between two ticks, after settling
    double least_force_n =
        0;  ///< along the axis, after settling; < 0: it pulled (contacts that push along +axis)
    double largest_force_n = 0;
    bool ran_away = false;  ///< |x| beyond `reach_m`
    bool finite = true;
  };
  double reach_m = 0.1;
  Outcome run(int ticks) const;

  /// Whether motion dies out: less of it in the last quarter than in the second, or less than `least_m` of it
  /// at all.
  static bool stable(const Outcome& outcome, double least_m);
};

/// Highest K in N/m, to half a percent, below which `stable` holds; `low` if even that fails, `high` if all
/// are stable.
double highest_stable(double low, double high, const std::function<bool(double stiffness)>& stable);

/// A wall whose force is stiffness · (depth − x), in `areas` equal parts, each with κ = `ratio` · its
/// stiffness; `pushes_only`: not below zero (else a spring that pulls, too: linear).
std::function<void(double, const Pose&, LawResult&)> linear_wall(double stiffness, double depth,
                                                                 std::uint32_t areas = 1, double ratio = 1,
                                                                 bool pushes_only = true);

}  // namespace palpate
