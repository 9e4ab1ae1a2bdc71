#pragma once
#include "cpu_ref/exact.h"
#include "model/lattice/voxel_grid.h"

namespace palpate::cpu_ref {

/// Whether the closed segment pq and the closed box share a point.
bool segment_meets_box(const Int3& p, const Int3& q, const Box& box);

/// Whether the closed triangle, not collapsed, and the closed box share a point.
bool triangle_meets_box(const Triangle& triangle, const Box& box);

/// Closed box of the voxels begin … end − 1, grown by `grow` steps on every side.
inline Box voxel_box(const VoxelGrid& grid, const Int3& begin, const Int3& end, std::int32_t grow) {
  Box box;
  box.min = grid.origin + grid.size * begin - Int3(grow);
  box.max = grid.origin + grid.size * end + Int3(grow);
  return box;
}

}  // namespace palpate::cpu_ref
