#pragma once
#include <cstdint>
#include <vector>

#include "compute/scene/scene_tables.h"
#include "model/scene/scene_geometry.h"

namespace palpate {

/// Side of the voxels, steps, of a second, finer partition of a closed tool, for early answers about samples;
/// 0: it is not worth its memory. `own`: the tool's first partition.
std::int32_t fine_voxel_size(const SceneGeometry& geometry, const gpu::GridConstants& own);

/// By boundary voxel of a closed tool's partition: the axis step that leads out of the solid through the
/// fewest boundary voxels (kBindFineExit).
std::vector<std::uint32_t> ways_out(const PartitionView& partition);

/// Cubes of a grid, those of which may hold some of the tool's solid.
class SolidCubes {
 public:
  /// None yet. `cubes` along each axis, along x a multiple of eight; `side` in steps. Allocates.
  SolidCubes(const Int3& cubes, double side);
  void add(int x, int y, int z) { rows_[place(x, y, z)] |= std::uint64_t{1} << (x & 63); }
  /// A bit a cube, x first: such a cube may be no further, in steps. Allocates.
  std::vector<std::uint32_t> near(double distance) const;

 private:
  std::size_t place(int x, int y, int z) const {
    return static_cast<std::size_t>(x >> 6) +
           static_cast<std::size_t>(words_) *
               (static_cast<std::size_t>(y) + static_cast<std::size_t>(n_.y) * static_cast<std::size_t>(z));
  }
  Int3 n_;
  double side_;
  int words_;                        ///< a row
  std::vector<std::uint64_t> rows_;  ///< along x
};

/// How far from a mock-up voxel's centre its samples lie, steps, as the tool sees them: half a diagonal, and
/// what rounding and a cube's border add.
inline double near_distance(std::int32_t voxel_size) { return 0.8660254037844387 * voxel_size + 4; }

/// A bit a voxel: its centre is within half a mock-up voxel's diagonal of the tool's solid, from a centre
/// anywhere in the voxel. Empty: it would take too much memory. `voxel_size`: of the mock-up.
std::vector<std::uint32_t> near_tool(const PartitionView& partition, std::int32_t voxel_size);

}  // namespace palpate
