#pragma once
#include "model/lattice/vector.h"

namespace palpate {

/// A contact as the force law extrapolates it: it pushes along `normal` with
/// max(0, force − stiffness · (normal·Δgc + lever·Δθ)), Δ the motion since the pose it belongs to. World
/// frame.
struct ContactPlane {
  Vec3 normal{0};        ///< unit
  Vec3 lever{0};         ///< torque about gc per newton, m
  double force = 0;      ///< N; < 0 for a wall that the tool has left: −κ times how far
  double stiffness = 0;  ///< κ, N/m: how fast the force gives way as the tool is drawn back
};

}  // namespace palpate
