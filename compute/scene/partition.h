#pragma once
#include <cstdint>
#include <vector>

#include "model/lattice/voxel_grid.h"
#include "shaders/shared/scene.h"

namespace palpate {

/// A voxel partition on the host (docs/EXACTNESS.md section 2), laid out as shaders read it
/// (lib/partition.glsl).
struct Partition {
  gpu::GridConstants grid{};
  std::vector<std::uint32_t> brick_slot;  ///< by brick: place in `bricks`, or kBrickExternal / kBrickInternal
  std::vector<gpu::Brick> bricks;         ///< mixed bricks, by ascending brick number
  std::vector<std::uint32_t> mixed_brick;     ///< by mixed brick: its brick number
  std::vector<std::uint32_t> boundary_place;  ///< by boundary voxel: slot · 512 + bit; ascending
  std::vector<std::uint32_t> list_begin;      ///< CSR over boundary voxels, + 1
  std::vector<std::uint32_t> list_triangles;  ///< ids, ascending in each voxel
  bool has_internal = false;

  std::uint64_t bytes() const {
    return 4 * (std::uint64_t{brick_slot.size()} + mixed_brick.size() + boundary_place.size() +
                list_begin.size() + list_triangles.size()) +
           sizeof(gpu::Brick) * std::uint64_t{bricks.size()};
  }
};

/// Number of bricks of a grid.
inline std::size_t brick_count(const Int3& bricks) {
  return static_cast<std::size_t>(bricks.x) * static_cast<std::size_t>(bricks.y) *
         static_cast<std::size_t>(bricks.z);
}

/// Brick of this number.
inline Int3 brick_at(const Int3& bricks, std::size_t number) {
  const auto nx = static_cast<std::size_t>(bricks.x), ny = static_cast<std::size_t>(bricks.y);
  return {static_cast<std::int32_t>(number % nx), static_cast<std::int32_t>(number / nx % ny),
          static_cast<std::int32_t>(number / (nx * ny))};
}

/// The same as data for comparison and export: every voxel's class.
VoxelPartition dense(const Partition& partition);

}  // namespace palpate
