#pragma once
#include <cstdint>
#include <optional>

#include "cpu_ref/exact.h"

namespace palpate::cpu_ref {

/// A triangle that a ray passes.
struct Crossing {
  int sign = 0;              ///< +1 leaving through an outward face, −1 entering
  std::uint32_t height = 0;  ///< H = floor(t · 2^30), t in units of the ray's direction; only where asked for
};

/// Whether the line through the perturbed point p + (ε, ε², ε³) along `direction` passes inside the triangle:
/// 0 if not, else the sign of direction · N.
int line_passes(const Int3& p, const Int3& direction, const Triangle& triangle);

/// The crossing of the ray from the perturbed p with the triangle (EXACTNESS section 1), without its height.
/// `direction` is not 0.
std::optional<Crossing> ray_crosses(const Int3& p, const Int3& direction, const Triangle& triangle);

/// The same with its height. |direction|'s largest component is at least 2^28, so that H fits 32 bits.
std::optional<Crossing> ray_crosses_at(const Int3& p, const Int3& direction, const Triangle& triangle);

/// Sign of the first component that is not 0; 0 for a zero vector.
int first_sign(const Long3& v);

}  // namespace palpate::cpu_ref
