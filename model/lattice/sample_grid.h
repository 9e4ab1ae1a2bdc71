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
  /// twice as wide would be, moved likewise. Cells' numbers fit into 32 bits; without a branch, for a loop
  /// over many cells.
  static constexpr std::int32_t level(std::int64_t cell_i, std::int64_t cell_j) {
    auto i = static_cast<std::int32_t>(cell_i), j = static_cast<std::int32_t>(cell_j);
    std::int32_t out = 0, goes_on = 1;  // 0 or 1
    for (int two = 0; two < kSampleLevels; two += 2) {
      const std::int32_t block_i = i >> 1, block_j = j >> 1,
                         off_i = (i & 1) ^ static_cast<std::int32_t>(golden(block_j) >> 31),
                         off_j = (j & 1) ^ static_cast<std::int32_t>(golden(block_i) >> 31);
      out += goes_on & ~(off_i ^ off_j);
      goes_on &= ~(off_i | off_j);
      out += goes_on;
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
