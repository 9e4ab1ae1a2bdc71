#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "driver/safe_device.h"
#include "model/scene/scene.h"
#include "service/loop/axis_loop.h"
#include "service/loop/virtual_coupling.h"

namespace palpate {

/// A place at which a body is pushed: where on the tool, which way, and by which share of the stiffness.
struct Pad {
  Vec3 at;      ///< from gc, tool frame, m
  Vec3 normal;  ///< unit, world
  double share = 1;
};

/// Makes the simulated device, at `start`, its tool's centre of mass at its origin.
using SimulatedMaker =
    std::function<Result<std::unique_ptr<HapticDevice>>(const DeviceSettings& settings, const Pose& start)>;

/// The yardstick of stability in six degrees of freedom: the simulated device and its hand
/// (driver/simulated_device.h: solved exactly over a tick), the safety wrapper, the shipped law and, if it is
/// on, the virtual coupling, closed over a contact in virtual time. Force and torque, guide and missing
/// motors included. Deterministic.
struct BodyLoop {
  SimulatedMaker make_device;
  DeviceSettings device;  ///< mass, inertia, hand, axes, guide; limits are raised so far that none is met
  bool passivity = false;
  Delivery delivery;
  ForceLawSettings law;
  CouplingSettings coupling;
  Pose at_rest;  ///< of gc
  std::function<void(const Pose& gc, LawResult& out)>
      contact;                          ///< fills wrench, contact and planes; the loop sets pose and tick
  Wrench load;                          ///< constant, about gc: what the hand presses with besides its spring
  Wrench kick{Vec3(0.01), Vec3(4e-4)};  ///< for one tick, once all is at rest: what is to die out
  int settle_ticks = 400;  ///< before the kick it is held at rest: how the force comes in is no part of this
  double reach_m = 0.1;

  /// Ranges are of gc and of the turn at 50 mm from it (a handle's size), as one length.
  AxisLoop::Outcome run(int ticks) const;
};

/// Pads on a flat wall each, of stiffness · share, that push by `load_n` · share at the rest pose; without
/// `pushes_only` they pull, too (linear).
std::function<void(const Pose&, LawResult&)> pads_contact(std::vector<Pad> pads, double stiffness,
                                                          double load_n, const Pose& at_rest,
                                                          bool pushes_only);

/// What pads_contact pushes with at rest.
Wrench pads_load(const std::vector<Pad>& pads, double load_n);

/// Highest stiffness that theory allows: the largest K for which B − K·J (T/2 + lag) is positive, B the
/// damping of device and hand, J = Σ share (n, r × n)(n, r × n)ᵀ, both on the axes that have a motor: the
/// linear limit (b + B) / (T/2 + t) for every motion at once.
double body_theory(const DeviceSettings& device, const std::vector<Pad>& pads, double lag_s);

}  // namespace palpate
