#pragma once
#include <cstdint>

#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Where a body is sampled, seen along an axis (EXACTNESS section 4): one point in each square cell (i, j),
/// moved within it by golden fractions. The points of a row of cells lie at heights that fill the row evenly,
/// so an edge along the axes, as CAD parts have, meets them one by one and not a row at once. Steps.
struct SampleGrid {
  std::int32_t spacing;  ///< side of a cell, ≥ 1

  /// 2^32 times the fractional part of n times the golden ratio.
  static constexpr std::uint32_t golden(std::int64_t n) {
    return static_cast<std::uint32_t>(n) * 2654435769u;
  }

  std::int64_t u(std::int64_t i, std::int64_t j) const { return i * spacing + moved(j); }
  std::int64_t v(std::int64_t i, std::int64_t j) const { return j * spacing + moved(i); }
  /// The number of the cells that hold a coordinate.
  std::int64_t cell(std::int64_t coordinate) const {
    const std::int64_t q = coordinate / spacing;
    return q - (q * spacing > coordinate ? 1 : 0);
  }

  /// The last level that a cell's point is of, at most kSampleLevels. Of a block of 2 × 2 cells two on a
  /// diagonal are of the next level, and one of these of the one after that: the one where a point of a grid
  /// twice as wide would be, moved likewise.
  static constexpr int level(std::int64_t i, std::int64_t j) {
    int out = 0;
    for (; out < kSampleLevels; out += 2) {
      const std::int64_t block_i = i >> 1, block_j = j >> 1;
      const auto right = static_cast<std::int64_t>(golden(block_j) >> 31),
                 up = static_cast<std::int64_t>(golden(block_i) >> 31);
      if (((i ^ j) & 1) != (right ^ up)) return out;
      if ((i & 1) != right) return out + 1;
      i = block_i;
      j = block_j;
    }
    return out;
  }

 private:
  std::int64_t moved(std::int64_t n) const {
    return static_cast<std::int64_t>((std::uint64_t{golden(n)} * static_cast<std::uint64_t>(spacing)) >> 32);
  }
};

}  // namespace palpate
