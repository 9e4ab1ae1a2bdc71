// Winding numbers at voxel centres: a row of centres along an axis sees each triangle that its line passes exactly once,
// as far as the last centre before it.
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
  std::uint64_t count() const { return static_cast<std::uint64_t>(size[u]) * static_cast<std::uint64_t>(size[v]); }
  std::uint64_t number(const Int3& voxel) const {
    return static_cast<std::uint64_t>(voxel[u]) + static_cast<std::uint64_t>(size[u]) * static_cast<std::uint64_t>(voxel[v]);
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

/// The last voxel of a row whose ray crosses a triangle that the row's line passes; `start` is the row's first centre.
std::int64_t last_before(const Int3& start, const Triangle& triangle, int axis, int facing, std::int64_t step) {
  // (a − p)·N · facing > 0 means ahead; a step along the row takes |N_axis| · step off it.
  const Int128 ahead = -triangle.side(start) * facing;
  const Int128 per_step = Int128{triangle.normal[axis]} * facing * step;
  const Int128 whole = floor_divide(ahead, per_step);
  const bool meets_a_centre = whole * per_step == ahead;
  // A centre in the triangle's plane: the perturbation says on which side of it the centre is.
  const bool centre_is_before = -first_sign(triangle.normal) == facing;
  return static_cast<std::int64_t>(meets_a_centre && !centre_is_before ? whole - 1 : whole);
}

std::vector<RowCrossing> row_crossings(const LatticeMesh& mesh, const Rows& rows, const std::vector<bool>& wanted) {
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
        crossings.push_back({rows.number(voxel), static_cast<std::int32_t>(std::min(last, std::int64_t{rows.size[rows.axis]} - 1)), facing});
      }
  }
  std::sort(crossings.begin(), crossings.end(), [](const RowCrossing& a, const RowCrossing& b) {
    return a.row != b.row ? a.row < b.row : a.last > b.last;
  });
  return crossings;
}

}  // namespace

void cast_ballots(const LatticeMesh& mesh, const VoxelGrid& grid, int axis, VoxelClass enclosed, std::vector<VoxelClass>& classes) {
  const Rows rows(grid, axis);
  const auto stride = [&](int k) {
    return k == 0 ? std::uint64_t{1} : k == 1 ? static_cast<std::uint64_t>(rows.size.x)
                                              : static_cast<std::uint64_t>(rows.size.x) * static_cast<std::uint64_t>(rows.size.y);
  };

  // Only rows with an enclosed voxel need their crossings.
  std::vector<bool> wanted(rows.count(), false);
  {
    Int3 voxel;
    std::uint64_t number = 0;
    for (voxel.z = 0; voxel.z < rows.size.z; ++voxel.z)
      for (voxel.y = 0; voxel.y < rows.size.y; ++voxel.y)
        for (voxel.x = 0; voxel.x < rows.size.x; ++voxel.x, ++number)
          if (classes[number] >= enclosed) wanted[rows.number(voxel)] = true;
  }

  // Walk each row from its far end: crossings ahead of a voxel come in one after the other.
  const std::vector<RowCrossing> crossings = row_crossings(mesh, rows, wanted);
  for (std::size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
    const std::uint64_t row = crossings[begin].row;
    while (end < crossings.size() && crossings[end].row == row) ++end;
    const auto size_u = static_cast<std::uint64_t>(rows.size[rows.u]);
    const std::uint64_t row_start = row % size_u * stride(rows.u) + row / size_u * stride(rows.v);
    std::int64_t winding = 0;
    std::size_t next = begin;
    for (std::int32_t i = rows.size[axis] - 1; i >= 0; --i) {
      for (; next < end && crossings[next].last >= i; ++next) winding += crossings[next].sign;
      VoxelClass& voxel = classes[row_start + static_cast<std::uint64_t>(i) * stride(axis)];
      if (winding != 0 && voxel >= enclosed) voxel = static_cast<VoxelClass>(static_cast<int>(voxel) + 1);
    }
  }
}

}  // namespace palpate::cpu_ref
