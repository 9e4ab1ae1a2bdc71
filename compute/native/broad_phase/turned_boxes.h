#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "compute/scene/brick_bits.h"
#include "compute/scene/scene_tables.h"

namespace palpate {

/// Boxes that turn with the tool, eight at a time in single precision: which voxels of the mock-up's grid
/// they may meet.
inline constexpr std::size_t kEight = 8;
using Eight = std::array<float, kEight>;

/// Tool lattice frame, steps. What is no box lies far beyond every grid (kNowhere), half 0.
struct EightBoxes {
  std::array<Eight, 3> centre, half;
};
/// Coordinate k of corner c of triangle i is at [3 c + k][i].
using EightTriangles = std::array<Eight, 9>;
inline constexpr float kNowhere = 1e30f;

/// A pose in voxels of the grid: a low is turned + below, a high turned + above.
struct VoxelTurn {
  float rotation[3][3], below[3], above[3];
  float end[3];  ///< the grid's voxels
};

/// Voxels first … last along each axis, clipped to the grid. `may` 0: none.
struct EightRanges {
  alignas(32) std::int32_t first[3][kEight], last[3][kEight], may[kEight];
  /// Of triangles alone: their boxes in kVoxelParts-ths of a voxel, as far as they lie in the grid.
  alignas(32) std::int32_t low[3][kEight], high[3][kEight];
  BrickBits::Range range(std::size_t i) const {
    return {{first[0][i], first[1][i], first[2][i]}, {last[0][i], last[1][i], last[2][i]}};
  }
};

void voxels_of(const VoxelTurn& turn, const EightBoxes& boxes, EightRanges& out);
/// Of the boxes of the turned corners.
void voxels_of(const VoxelTurn& turn, const EightTriangles& triangles, EightRanges& out);

}  // namespace palpate
