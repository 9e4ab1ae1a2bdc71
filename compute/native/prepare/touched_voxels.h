#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"

namespace palpate::native {

/// By brick of a grid: 1 where a body touches it, else 0. A brick is touched exactly where a voxel of it is.
/// On all cores.
std::vector<std::uint32_t> touched_bricks(const LatticeMesh& mesh, const VoxelGrid& grid);

/// The voxels of a brick, a bit each: x + 8 y + 64 z from the first word's lowest on.
using BrickBits = std::array<std::uint32_t, 16>;
/// Which voxels a body touches: of brick b those of element place[b], one of `count`; 64 bytes each and
/// nothing besides. `place` knows all of touched_bricks(). On all cores.
std::vector<BrickBits> touched_voxels(const LatticeMesh& mesh, const VoxelGrid& grid,
                                      const std::vector<std::int32_t>& place, std::size_t count);

}  // namespace palpate::native
