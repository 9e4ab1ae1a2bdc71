#pragma once
#include <cstdint>

#include "model/lattice/vector.h"

namespace palpate {

/// Largest |coordinate| of anything a predicate sees, in lattice steps. Every bound in the predicates rests
/// on it.
inline constexpr std::int32_t kLatticeReach = 1 << 28;

/// The integer lattice on which all geometry of a scene lives: metre = origin_m + step_m · value, world
/// frame.
struct Lattice {
  double step_m = 0;  ///< a power of two of a metre
  Vec3 origin_m{0};   ///< whole multiples of step_m, near the centre of the mock-up's box
};

/// A pose as every back end sees it: world lattice point of a tool lattice point v is
/// ((rotation_q30 · v + 2^29) >> 30) + translation, in 64-bit integers, arithmetic shift.
struct LatticePose {
  std::int32_t rotation_q30[3][3] = {};  ///< row-major, world from tool, each |entry| ≤ 2^30
  Int3 translation{0};  ///< lattice steps; beyond_lattice: 0 where the tool's vertices would be too far for
                        ///< exact predicates
  bool beyond_lattice = false;  ///< the tool can't reach the mock-up's grid: free, zero wrench
};

/// Applies a lattice pose; exact, the same on every device.
inline Int3 transform(const LatticePose& pose, const Int3& v) {
  Int3 out;
  for (int r = 0; r < 3; ++r) {
    const std::int64_t sum = std::int64_t{pose.rotation_q30[r][0]} * v.x +
                             std::int64_t{pose.rotation_q30[r][1]} * v.y +
                             std::int64_t{pose.rotation_q30[r][2]} * v.z + (std::int64_t{1} << 29);
    out[r] = static_cast<std::int32_t>(sum >> 30) + pose.translation[r];
  }
  return out;
}

}  // namespace palpate
