#pragma once
#include <array>
#include <cstdint>

#include "model/lattice/lattice.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/vector.h"

/// Integer arithmetic wide enough that nothing here ever rounds. Lattice steps throughout. Bounds:
/// |coordinate| ≤ 2^28, so differences stay within 2^29, raw normals within 2^59.2 a component, N·(p − a)
/// within 2^90 and that times 2^30 within 2^120: 128 bits hold every product of docs/EXACTNESS.md.
namespace palpate::cpu_ref {

__extension__ typedef __int128 Int128;

inline int sign(Int128 value) { return (value > 0) - (value < 0); }

/// Division that rounds towards −∞; `divisor` > 0.
inline Int128 floor_divide(Int128 value, Int128 divisor) {
  const Int128 quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}
inline std::int64_t floor_divide(std::int64_t value, std::int64_t divisor) {
  const std::int64_t quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

inline Long3 difference(const Int3& to, const Int3& from) { return Long3(to) - Long3(from); }

inline Int128 dot(const Long3& a, const Long3& b) {
  return Int128{a.x} * b.x + Int128{a.y} * b.y + Int128{a.z} * b.z;
}

/// Of differences of lattice points: each product within 2^58, each component within 2^59.2.
inline Long3 cross(const Long3& a, const Long3& b) {
  return Long3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/// A box with its faces; empty when min > max on some axis.
struct Box {
  Int3 min{INT32_MAX}, max{INT32_MIN};
  void include(const Int3& p) {
    for (int k = 0; k < 3; ++k) {
      if (p[k] < min[k]) min[k] = p[k];
      if (p[k] > max[k]) max[k] = p[k];
    }
  }
  bool meets(const Box& other) const {
    for (int k = 0; k < 3; ++k)
      if (min[k] > other.max[k] || max[k] < other.min[k]) return false;
    return true;
  }
};

/// Three lattice points and their raw normal N = (b − a) × (c − a). N = 0: collapsed, in nothing.
struct Triangle {
  std::array<Int3, 3> corners{};
  Long3 normal{0};

  Triangle() = default;
  Triangle(const Int3& a, const Int3& b, const Int3& c)
      : corners{a, b, c}, normal(cross(difference(b, a), difference(c, a))) {}

  const Int3& operator[](int k) const { return corners[static_cast<std::size_t>(k)]; }
  bool collapsed() const { return normal == Long3(0); }
  Box box() const {
    Box result;
    for (const Int3& corner : corners) result.include(corner);
    return result;
  }
  /// N·(p − a): its sign is the side of the plane on which p lies.
  Int128 side(const Int3& p) const { return dot(normal, difference(p, corners[0])); }
};

inline Triangle triangle_of(const LatticeMesh& mesh, std::uint32_t id) {
  return Triangle(mesh.corner(id, 0), mesh.corner(id, 1), mesh.corner(id, 2));
}

}  // namespace palpate::cpu_ref
