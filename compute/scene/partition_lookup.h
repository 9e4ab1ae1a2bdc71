#pragma once
#include <bit>
#include <cstdint>
#include <span>

#include "compute/scene/scene_tables.h"
#include "model/lattice/vector.h"

namespace palpate {

/// A voxel partition to look things up in. What the view names outlives this.
class PartitionLookup {
 public:
  PartitionLookup() = default;
  explicit PartitionLookup(const PartitionView& from)
      : grid_(from.grid),
        per_voxel_(1.0 / from.grid.size),
        slots_(from.brick_slot),
        list_begin_(from.list_begin),
        list_triangles_(from.list_triangles),
        bricks_(from.bricks) {}
  const gpu::GridConstants& grid() const { return grid_; }

  struct Voxel {
    std::uint32_t kind = gpu::kVoxelExternal;  ///< kVoxel…
    std::uint32_t boundary = gpu::kNoVoxel;    ///< the number of a V_bnd voxel
  };
  /// Any voxel; beyond the grid it is V_ext.
  Voxel at(const Int3& v) const {
    const Int3& n = grid_.bricks;
    for (int k = 0; k < 3; ++k)
      if (v[k] < 0 || v[k] >= 8 * n[k]) return {};
    const std::uint32_t slot =
        slots_[static_cast<std::size_t>(v.x >> 3) +
               static_cast<std::size_t>(n.x) *
                   (static_cast<std::size_t>(v.y >> 3) +
                    static_cast<std::size_t>(n.y) * static_cast<std::size_t>(v.z >> 3))];
    if (slot >= gpu::kBrickInternal)
      return {slot == gpu::kBrickInternal ? gpu::kVoxelInternal : gpu::kVoxelExternal, gpu::kNoVoxel};
    const auto bit = static_cast<unsigned>((v.x & 7) | (v.y & 7) << 3 | (v.z & 7) << 6);
    const gpu::Brick& brick = bricks_[slot];
    const std::uint32_t word = brick.boundary[bit >> 5];
    if ((word >> (bit & 31) & 1) != 0)
      return {
          gpu::kVoxelBoundary,
          brick.first[bit >> 5] + static_cast<std::uint32_t>(std::popcount(word & ((1u << (bit & 31)) - 1)))};
    return {(brick.internal_[bit >> 5] >> (bit & 31) & 1) != 0 ? gpu::kVoxelInternal : gpu::kVoxelExternal,
            gpu::kNoVoxel};
  }
  /// The voxel that holds a lattice point.
  Int3 voxel_of(const Int3& p) const {
    Int3 v;
    for (int k = 0; k < 3; ++k) {
      // Half a step from the nearest integer quotient, which is far more than a double rounds.
      const double along = (static_cast<double>(p[k]) - grid_.origin[k] + 0.5) * per_voxel_;
      v[k] = static_cast<std::int32_t>(along);
      if (along < 0) --v[k];
    }
    return v;
  }
  /// What the V_bnd voxel of this number lists.
  std::span<const std::uint32_t> list(std::uint32_t boundary) const {
    const std::uint32_t begin = list_begin_[boundary];
    return list_triangles_.subspan(begin, list_begin_[boundary + 1] - begin);
  }
  /// Of the V_bnd voxel of this number: its list's first place in all lists together.
  std::uint32_t list_begin(std::uint32_t boundary) const { return list_begin_[boundary]; }
  /// The V_bnd voxels among eight in a row along x, the first of them at a whole multiple of eight: a bit
  /// each, and the number of the first.
  struct Row {
    std::uint32_t boundary = 0, first = 0;
  };
  Row row(std::int32_t brick_x, std::int32_t y, std::int32_t z) const {
    const Int3& n = grid_.bricks;
    const std::uint32_t slot = slots_[static_cast<std::size_t>(brick_x) +
                                      static_cast<std::size_t>(n.x) *
                                          (static_cast<std::size_t>(y >> 3) +
                                           static_cast<std::size_t>(n.y) * static_cast<std::size_t>(z >> 3))];
    if (slot >= gpu::kBrickInternal) return {};
    const auto word = static_cast<std::size_t>((y & 7) >> 2 | (z & 7) << 1);
    const gpu::Brick& brick = bricks_[slot];
    const std::uint32_t shift = static_cast<std::uint32_t>(y & 3) * 8, bits = brick.boundary[word];
    return {bits >> shift & 0xFF,
            brick.first[word] + static_cast<std::uint32_t>(std::popcount(bits & ((1u << shift) - 1)))};
  }
  /// Entry `i` of all lists together.
  std::uint32_t listed(std::uint32_t i) const { return list_triangles_[i]; }

 private:
  gpu::GridConstants grid_{};
  double per_voxel_ = 0;  ///< voxels a step
  std::span<const std::uint32_t> slots_, list_begin_, list_triangles_;
  std::span<const gpu::Brick> bricks_;
};

}  // namespace palpate
