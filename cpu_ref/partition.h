#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cpu_ref/exact.h"
#include "model/collision_backend.h"
#include "model/lattice_mesh.h"
#include "model/voxel_grid.h"

namespace palpate::cpu_ref {

/// Most voxels that a grid may have here: classes are kept dense, a byte each (chosen: 2 GiB).
inline constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 31;

/// The voxel partition of one body (EXACTNESS section 2).
struct Partition {
  VoxelPartition voxels;
  bool has_internal = false;
  std::vector<bool> brick_is_external;   ///< every voxel of the brick is V_ext; x fastest

  std::uint64_t number(const Int3& voxel) const {
    const Int3 n = voxels.grid.voxels();
    return static_cast<std::uint64_t>(voxel.x) +
           static_cast<std::uint64_t>(n.x) *
               (static_cast<std::uint64_t>(voxel.y) + static_cast<std::uint64_t>(n.y) * static_cast<std::uint64_t>(voxel.z));
  }
  /// Where a linear voxel number lies.
  Int3 voxel(std::uint64_t number) const;
  /// The voxel whose half-open cube holds a point; may be off the grid.
  Int3 holding(const Int3& point) const;
  bool in_grid(const Int3& voxel) const;
  /// Class of the voxel that holds a point; V_ext off the grid.
  VoxelClass class_of(const Int3& point) const;
  Int3 centre(const Int3& voxel) const {
    return voxels.grid.origin + voxels.grid.size * voxel + Int3(voxels.grid.size / 2);
  }
  /// The triangles that a V_bnd voxel lists, ascending; empty for other voxels.
  std::span<const std::uint32_t> listed(std::uint64_t number) const;
  /// Whether a block of voxels lies in one brick that is V_ext throughout.
  bool block_is_external(const Int3& begin, const Int3& end) const;
  /// Centre of the V_ext voxel nearest to `point` minus the point (EXACTNESS section 6).
  Long3 to_nearest_external(const Int3& point) const;

  std::uint64_t memory_bytes() const;
};

/// `grow`: steps by which every cube grows before it is asked what it touches (0 mock-up, 3 tool).
/// Errors: kBadValue for a grid of more than kMaxVoxels, kUsage when `progress` says stop.
Result<Partition> make_partition(const LatticeMesh& mesh, const VoxelGrid& grid, std::int32_t grow, const Progress& progress);

/// Adds one to `classes[v]`, for every voxel v with classes[v] ≥ `enclosed`, if the winding of the ray from v's centre
/// along +axis is not 0.
void cast_ballots(const LatticeMesh& mesh, const VoxelGrid& grid, int axis, VoxelClass enclosed, std::vector<VoxelClass>& classes);

}  // namespace palpate::cpu_ref
