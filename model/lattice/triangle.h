#pragma once
#include <cstdint>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// N = (b − a) × (c − a) of lattice points: differences are below 2^29 + 1, so components stay within 2^59.2.
inline Long3 raw_normal(const Int3& a, const Int3& b, const Int3& c) {
  const Long3 u = Long3(b) - Long3(a), v = Long3(c) - Long3(a);
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// Raw normal of a triangle as it is turned now; 0 if it collapsed.
inline Long3 raw_normal(const LatticeMesh& mesh, std::uint32_t triangle) {
  return raw_normal(mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2));
}

/// Axis of the normal's largest component; ties: the lowest.
inline int dominant_axis(const Long3& normal) {
  const auto size = [&](int axis) { return normal[axis] < 0 ? -normal[axis] : normal[axis]; };
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (size(k) > size(axis)) axis = k;
  return axis;
}

}  // namespace palpate
