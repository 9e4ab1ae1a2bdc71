#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "model/lattice/vector.h"

namespace palpate {

/// A sum of 64-bit terms kept in two limbs: value = high · 2^32 + low, low ≥ 0.
struct WideSum {
  std::int64_t low = 0;   ///< sum of the terms' low 32 bits
  std::int64_t high = 0;  ///< sum of the terms >> 32 (arithmetic)
  bool operator==(const WideSum&) const = default;
  /// Adds limb by limb.
  WideSum& operator+=(const WideSum& more) {
    low += more.low;
    high += more.high;
    return *this;
  }
};

/// By how many bits a lever is shortened where only its rough size matters: what is left of the tool's radius
/// is below 2^14.
constexpr int lever_shift(std::int32_t tool_radius) {
  int shift = 0;
  while ((tool_radius >> shift) >= 1 << 14) ++shift;
  return shift;
}

/// Directions in which pushes are summed apart: −1, 0 or 1 along each axis, 0 0 0 (the middle one) never.
inline constexpr std::uint32_t kFieldBins = 27;

/// Pushes of about one direction, summed (docs/EXACTNESS.md section 8). Lattice steps; levers from the tool's
/// lattice origin, world axes.
struct FieldBin {
  std::uint32_t samples = 0;      ///< that push
  std::array<WideSum, 3> push{};  ///< Σ P n: force
  std::array<WideSum, 3> turn{};  ///< Σ P (r × n): torque about the tool's lattice origin
  std::int64_t give = 0;  ///< Σ k: how the force gives way along the push; for the law and the solver alone
  std::array<std::int64_t, 3> give_at{};      ///< Σ k r', r' = r >> lever_shift(tool_radius)
  std::array<std::int64_t, 6> give_spread{};  ///< Σ k r' r'ᵀ: xx yy zz xy yz zx
  bool operator==(const FieldBin&) const = default;
};

/// What the pressure field says at a pose: integers, the same on every back end.
struct FieldSums {
  std::array<FieldBin, kFieldBins> bins{};
  std::uint32_t max_depth = 0;  ///< φ of the deepest samples, steps; 0: nothing is deep
  std::uint32_t deepest_static =
      0;  ///< smallest static triangle of those samples: their own, or the nearest one
  std::uint32_t deepest_mobile = 0;  ///< likewise of the tool
  bool operator==(const FieldSums&) const = default;
};

/// A static triangle that carries contact: its own samples inside the tool, for the areas that people see.
struct CarrierSums {
  std::uint32_t id = 0;
  std::uint32_t samples = 0;
  std::uint32_t max_depth = 0;      ///< steps
  std::int64_t weight_sum = 0;      ///< Σ w, Q24
  std::int64_t depth_sum = 0;       ///< Σ P
  std::array<WideSum, 3> push{};    ///< Σ P n
  std::array<WideSum, 3> moment{};  ///< Σ (P r) >> 10
  bool operator==(const CarrierSums&) const = default;
  /// Adds what another part of its samples says; the id stays.
  CarrierSums& operator+=(const CarrierSums& more) {
    samples += more.samples;
    max_depth = std::max(max_depth, more.max_depth);
    weight_sum += more.weight_sum;
    depth_sum += more.depth_sum;
    for (std::size_t k = 0; k < 3; ++k) {
      push[k] += more.push[k];
      moment[k] += more.moment[k];
    }
    return *this;
  }
};

}  // namespace palpate
