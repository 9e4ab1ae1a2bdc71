#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cpu_ref/brick_classes.h"
#include "cpu_ref/exact.h"
#include "model/collision_backend.h"
#include "model/lattice/lattice_mesh.h"
#include "model/lattice/voxel_grid.h"

namespace palpate::cpu_ref {

/// Most bricks that a grid may have here (chosen: 256 MiB of coarse states).
inline constexpr std::uint64_t kMaxBricks = std::uint64_t{1} << 26;

/// Most voxels that are handed out one by one, for export and comparison (chosen: 4 GiB).
inline constexpr std::uint64_t kMaxDenseVoxels = std::uint64_t{1} << 32;

/// The voxel partition of one body (EXACTNESS section 2).
struct Partition {
  VoxelGrid grid;
  BrickClasses classes;
  std::vector<std::uint64_t> boundary_voxels;  ///< linear voxel numbers, ascending
  std::vector<std::uint64_t>
      list_begin;  ///< of each boundary voxel's triangles in list_triangles, one more at the end
  std::vector<std::uint32_t> list_triangles;  ///< ids, ascending in each voxel
  bool has_internal = false;

  std::uint64_t number(const Int3& voxel) const {
    const Int3 n = grid.voxels();
    return static_cast<std::uint64_t>(voxel.x) +
           static_cast<std::uint64_t>(n.x) *
               (static_cast<std::uint64_t>(voxel.y) +
                static_cast<std::uint64_t>(n.y) * static_cast<std::uint64_t>(voxel.z));
  }
  /// Where a linear voxel number lies.
  Int3 voxel(std::uint64_t number) const;
  /// The voxel whose half-open cube holds a point; may be off the grid.
  Int3 holding(const Int3& point) const;
  bool in_grid(const Int3& voxel) const;
  /// Class of the voxel that holds a point; V_ext off the grid.
  VoxelClass class_of(const Int3& point) const;
  Int3 centre(const Int3& voxel) const { return grid.origin + grid.size * voxel + Int3(grid.size / 2); }
  /// The triangles that a V_bnd voxel lists, ascending; empty for other voxels.
  std::span<const std::uint32_t> listed(std::uint64_t number) const;
  /// Whether a block of voxels lies in one brick that is V_ext throughout.
  bool block_is_external(const Int3& begin, const Int3& end) const;
  /// Centre of the V_ext voxel nearest to `point` minus the point (EXACTNESS section 6).
  Long3 to_nearest_external(const Int3& point) const;

  /// Every voxel's class, for export and comparison. Error (kBadValue): more than kMaxDenseVoxels.
  Result<VoxelPartition> dense() const;
  std::uint64_t memory_bytes() const;
};

/// `grow`: steps by which every cube grows before it is asked what it touches (0 mock-up, 3 tool).
/// Errors: kBadValue for a grid of more than kMaxBricks, kUsage when `progress` says stop.
Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t grow,
                                 const Progress& progress);

/// What the voxels of an enclosed component have said: ballots of non-zero winding.
struct Ballots {
  std::vector<std::uint16_t> of_brick;  ///< for uniform bricks, over all their voxels: at most 3 · 512
};

/// Asks the winding of the ray from the centre of every voxel of class ≥ `undecided` along +axis. Where it is
/// not 0, a voxel in a detailed brick goes up by one class, and a uniform brick's ballots go up by one.
void cast_ballots(const LatticeMesh& mesh, const VoxelGrid& grid, int axis, VoxelClass undecided,
                  BrickClasses& classes, Ballots& ballots);

}  // namespace palpate::cpu_ref
