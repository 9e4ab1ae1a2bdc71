#pragma once
#include "cpu_ref/triangle_cube.h"

namespace palpate::cpu_ref {

/// Calls visit(voxel) for every voxel of the grid whose closed cube, grown by `grow` steps, touches the
/// triangle, and asks wanted(begin, end) before it looks into a block of voxels begin … end − 1. Blocks are
/// halved where their closed box touches the triangle, so the work follows the triangle's area and not its
/// box's volume.
template <class Wanted, class Visit>
void for_each_touched_voxel(const Triangle& triangle, const VoxelGrid& grid, std::int32_t grow,
                            const Wanted& wanted, const Visit& visit) {
  const auto descend = [&](const auto& self, const Int3& begin, const Int3& end) -> void {
    if (!wanted(begin, end) || !triangle_meets_box(triangle, voxel_box(grid, begin, end, grow))) return;
    const Int3 size = end - begin;
    const int k = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    if (size[k] == 1) {
      visit(begin);
      return;
    }
    // Cut at a brick's border where there is one, so that blocks soon lie within a brick.
    std::int32_t middle = begin[k] + size[k] / 2;
    const std::int32_t brick = middle / kBrickSide * kBrickSide;
    if (brick > begin[k]) middle = brick;
    Int3 low_end = end, high_begin = begin;
    low_end[k] = high_begin[k] = middle;
    self(self, begin, low_end);
    self(self, high_begin, end);
  };

  // The block of voxels that the triangle's box touches, cut to the grid.
  const Box box = triangle.box();
  Int3 begin, end;
  for (int k = 0; k < 3; ++k) {
    const std::int64_t low = std::int64_t{box.min[k]} - grow - grid.origin[k],
                       high = std::int64_t{box.max[k]} + grow - grid.origin[k];
    const std::int64_t first = std::max(floor_divide(low - 1, std::int64_t{grid.size}), std::int64_t{0});
    const std::int64_t last =
        std::min(floor_divide(high, std::int64_t{grid.size}), std::int64_t{grid.voxels()[k]} - 1);
    if (first > last) return;
    begin[k] = static_cast<std::int32_t>(first);
    end[k] = static_cast<std::int32_t>(last + 1);
  }
  descend(descend, begin, end);
}

}  // namespace palpate::cpu_ref
