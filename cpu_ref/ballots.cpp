// Winding numbers at voxel centres: a row of centres along an axis sees each triangle that its line passes
// exactly once, as far as the last centre before it.
#include <algorithm>

#include "cpu_ref/partition.h"
#include "cpu_ref/ray.h"

namespace palpate::cpu_ref {
namespace {

/// A line through the centres of a row of voxels passes a triangle; the rays from voxels 0 … last cross it.
struct RowCrossing {
  std::uint64_t row = 0;
  std::int32_t last = 0;
  std::int32_t sign = 0;
};

/// Rows are numbered by their place in the plane of the two other axes.
struct Rows {
  const VoxelGrid& grid;
  int axis, u, v;
  Int3 size;

  Rows(const VoxelGrid& g, int a) : grid(g), axis(a), u((a + 1) % 3), v((a + 2) % 3), size(g.voxels()) {}
  std::uint64_t count() const {
    return static_cast<std::uint64_t>(size[u]) * static_cast<std::uint64_t>(size[v]);
  }
  std::uint64_t number(const Int3& voxel) const {
    return static_cast<std::uint64_t>(voxel[u]) +
           static_cast<std::uint64_t>(size[u]) * static_cast<std::uint64_t>(voxel[v]);
  }
  /// The first voxel of a row.
  Int3 start(std::uint64_t row) const {
    Int3 voxel(0);
    voxel[u] = static_cast<int>(row % static_cast<std::uint64_t>(size[u]));
    voxel[v] = static_cast<int>(row / static_cast<std::uint64_t>(size[u]));
    return voxel;
  }
  /// First and last voxel along k whose centre lies within [low, high].
  std::pair<std::int32_t, std::int32_t> centres(int k, std::int32_t low, std::int32_t high) const {
    const std::int64_t first_centre = std::int64_t{grid.origin[k]} + grid.size / 2;
    const std::int64_t first = -floor_divide(first_centre - low, std::int64_t{grid.size});
    const std::int64_t last = floor_divide(high - first_centre, std::int64_t{grid.size});
    return {static_cast<std::int32_t>(std::max(first, std::int64_t{0})),
            static_cast<std::int32_t>(std::min(last, std::int64_t{size[k]} - 1))};
  }
};

/// The last voxel of a row whose ray crosses a triangle that the row's line passes; `start` is the row's
/// first centre. A centre on the triangle itself is in a V_bnd voxel and never asks, so that its tie need not
/// be broken.
std::int64_t last_before(const Int3& start, const Triangle& triangle, int axis, int facing,
                         std::int64_t step) {
  // (a − p)·N · facing > 0 means ahead; a step along the row takes |N_axis| · step off it.
  return static_cast<std::int64_t>(
      floor_divide(-triangle.side(start) * facing, Int128{triangle.normal[axis]} * facing * step));
}

std::vector<RowCrossing> row_crossings(const LatticeMesh& mesh, const Rows& rows,
                                       const std::vector<bool>& wanted) {
  std::vector<RowCrossing> crossings;
  Int3 along(0);
  along[rows.axis] = 1;
  for (std::uint32_t id = 0; id < mesh.triangles.size(); ++id) {
    if (mesh.collapsed(id)) continue;
    const Triangle triangle = triangle_of(mesh, id);
    if (triangle.normal[rows.axis] == 0) continue;
    const Box box = triangle.box();
    const auto [first_u, last_u] = rows.centres(rows.u, box.min[rows.u], box.max[rows.u]);
    const auto [first_v, last_v] = rows.centres(rows.v, box.min[rows.v], box.max[rows.v]);
    Int3 voxel(0);
    for (voxel[rows.v] = first_v; voxel[rows.v] <= last_v; ++voxel[rows.v])
      for (voxel[rows.u] = first_u; voxel[rows.u] <= last_u; ++voxel[rows.u]) {
        if (!wanted[rows.number(voxel)]) continue;
        const Int3 start = rows.grid.origin + rows.grid.size * voxel + Int3(rows.grid.size / 2);
        const int facing = line_passes(start, along, triangle);
        if (facing == 0) continue;
        const std::int64_t last = last_before(start, triangle, rows.axis, facing, rows.grid.size);
        if (last < 0) continue;
        crossings.push_back(
            {rows.number(voxel),
             static_cast<std::int32_t>(std::min(last, std::int64_t{rows.size[rows.axis]} - 1)), facing});
      }
  }
  std::sort(crossings.begin(), crossings.end(), [](const RowCrossing& a, const RowCrossing& b) {
    return a.row != b.row ? a.row < b.row : a.last > b.last;
  });
  return crossings;
}

/// Only rows with a voxel that asks need their crossings.
std::vector<bool> rows_with(VoxelClass undecided, const Rows& rows, const BrickClasses& classes) {
  std::vector<bool> wanted(rows.count(), false);
  for (std::size_t brick = 0; brick < classes.brick_count(); ++brick) {
    const Int3 first = classes.first_voxel(brick);
    if (classes.uniform(brick) && classes.at(first) < undecided) continue;
    for (int z = 0; z < kBrickSide; ++z)
      for (int y = 0; y < kBrickSide; ++y)
        for (int x = 0; x < kBrickSide; ++x)
          if (classes.at(first + Int3(x, y, z)) >= undecided)
            wanted[rows.number(first + Int3(x, y, z))] = true;
  }
  return wanted;
}

}  // namespace

void cast_ballots(const LatticeMesh& mesh, const VoxelGrid& grid, int axis, VoxelClass undecided,
                  BrickClasses& classes, Ballots& ballots) {
  const Rows rows(grid, axis);
  const std::vector<RowCrossing> crossings = row_crossings(mesh, rows, rows_with(undecided, rows, classes));
  // Walk each row from its far end: crossings ahead of a voxel come in one after the other.
  for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
    while (end < crossings.size() && crossings[end].row == crossings[begin].row) ++end;
    Int3 voxel = rows.start(crossings[begin].row);
    std::int64_t winding = 0;
    std::size_t next = begin;
    for (voxel[axis] = rows.size[axis] - 1; voxel[axis] >= 0; --voxel[axis]) {
      for (; next < end && crossings[next].last >= voxel[axis]; ++next) winding += crossings[next].sign;
      if (winding == 0) continue;
      const VoxelClass c = classes.at(voxel);
      if (c < undecided) continue;
      const std::size_t brick = classes.brick_of(voxel);
      if (classes.uniform(brick))
        ++ballots.of_brick[brick];
      else
        classes.mark(voxel, static_cast<VoxelClass>(static_cast<int>(c) + 1));
    }
  }
}

}  // namespace palpate::cpu_ref
