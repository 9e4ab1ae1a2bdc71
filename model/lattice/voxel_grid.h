#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/vector.h"

namespace palpate {

inline constexpr std::int32_t kBrickSide = 8;  ///< voxels along a brick's edge

/// A regular grid of cubes on the lattice. Voxel (i,j,k) is the cube [origin + size·(i,j,k), + size], closed
/// when it is asked what it touches, half-open [ , ) when it is asked which voxel a point lies in. All
/// outside the grid is V_ext.
struct VoxelGrid {
  Int3 origin{0};         ///< lattice point of voxel (0,0,0)'s lower corner, a multiple of size
  std::int32_t size = 0;  ///< edge of a voxel in lattice steps, even
  Int3 bricks{0};         ///< bricks along each axis; voxels = 8 × bricks
  /// Voxels along each axis.
  Int3 voxels() const { return bricks * kBrickSide; }
};

/// Class of a voxel (chapter 3.1). The numbers are those of voxels.u8 of `--export-geometry`.
enum class VoxelClass : std::uint8_t { kExternal = 0, kBoundary = 1, kInternal = 2 };

/// The partition of one body, as data for comparison and export: dense, x fastest.
struct VoxelPartition {
  VoxelGrid grid;
  std::vector<VoxelClass> classes;             ///< voxels().x · y · z
  std::vector<std::uint64_t> boundary_voxels;  ///< linear voxel numbers, ascending
  std::vector<std::uint64_t> list_begin;       ///< CSR, boundary_voxels.size() + 1
  std::vector<std::uint32_t> list_triangles;   ///< ids, ascending in each voxel
};

}  // namespace palpate
