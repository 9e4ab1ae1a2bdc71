#pragma once
#include "model/lattice/pose.h"
#include "model/mesh/mesh.h"

namespace palpate {

/// What the plain method says of one contact.
struct PlainAnswer {
  bool contact = false;
  double depth = 0;  ///< m: of the mock-up's samples inside the tool, their mean by weight
  Vec3 force{0};     ///< N
};

/// The pressure field of `refined` in floating point throughout, as one would write it first: the tool's
/// vertices transformed, samples on a square grid over each triangle, inside the other body or not by
/// the winding along a ray, its depth the distance to the nearest triangle, F = K / (2 A_ref) Σ w φ n. No
/// lattice, no exact predicate, no tolerance. For comparison alone (`bench numerics`): brute force over all
/// triangles, for minutes where there are many; once interrupted() it ends early, and its answer
/// means nothing: ask interrupted() before it is used.
template <class Real>
PlainAnswer plain_response(const Mesh& mockup, const Mesh& tool, const Pose& pose, double spacing_m,
                           double stiffness_n_per_m, double reference_area_m2);

extern template PlainAnswer plain_response<float>(const Mesh&, const Mesh&, const Pose&, double, double,
                                                  double);
extern template PlainAnswer plain_response<double>(const Mesh&, const Mesh&, const Pose&, double, double,
                                                   double);

/// A wall at `wall` m along x, and a tool at `x` whose result is of `x_then`: max(0, K d − K Δx), d the depth
/// then. The force law's arithmetic on one plane.
template <class Real>
double plain_extrapolation(double wall, double x_then, double x, double stiffness_n_per_m) {
  const auto k = static_cast<Real>(stiffness_n_per_m), then = static_cast<Real>(x_then),
             now = static_cast<Real>(x), at = static_cast<Real>(wall);
  const Real force = k * (at - then) - k * (now - then);
  return force > Real(0) ? static_cast<double>(force) : 0.0;
}

}  // namespace palpate
