#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "compute/scene/exact.h"

namespace palpate {

/// Pairs of triangles judged in single precision, several at a time, where that is enough (docs/EXACTNESS.md,
/// section 9). One thread.
class PairFilter {
 public:
  static constexpr std::size_t kLanes = 8;
  /// Coordinate k of corner c, relative to t's first corner, at [3 c + k][lane]; of t without that corner.
  using Coordinates = std::array<std::array<std::int32_t, kLanes>, 9>;
  enum Verdict : std::uint8_t { kApart, kMeet, kUnknown };  // kUnknown: exact::triangles_meet has to say

  /// Neither triangle may be collapsed. Coordinates as exact.h has them.
  void put(std::size_t lane, const exact::Corners& s, const exact::Corners& t) {
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        s_[3 * corner + k][lane] = s[corner][axis] - t[0][axis];
        if (corner > 0) t_[3 * (corner - 1) + k][lane] = t[corner][axis] - t[0][axis];
      }
  }
  /// Eight triangles, coordinate k of corner c at [3 c + k], before one.
  void put(const Coordinates& s, const exact::Corners& t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (std::size_t lane = 0; lane < kLanes; ++lane)
          s_[3 * corner + k][lane] = s[3 * corner + k][lane] - t[0][axis];
      for (std::size_t corner = 1; corner < 3; ++corner)
        t_[3 * (corner - 1) + k].fill(t[corner][axis] - t[0][axis]);
    }
  }
  /// Of all lanes; what was not put says nothing.
  void judge(std::array<Verdict, kLanes>& out) const;

 private:
  alignas(64) Coordinates s_{}, t_{};
};

}  // namespace palpate
