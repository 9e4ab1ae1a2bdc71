#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "compute/scene/brick_bits.h"
#include "compute/scene/partition_lookup.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Which parts of the V_bnd voxels of a body that is not closed lie inside it: cells of an eighth of a voxel
/// through which no triangle passes have one answer each (docs/EXACTNESS.md section 9). Any number of
/// threads; only the constructor allocates.
class InsideCells {
 public:
  /// Whether a point in a V_bnd voxel, of number `boundary`, lies inside.
  using Ask = std::function<bool(const Int3& point, const Int3& voxel, std::uint32_t boundary)>;

  InsideCells() = default;
  /// `boxes`: SearchTables::boxes of `partition`. A body of very many voxels gets no cells.
  InsideCells(const LatticeMesh& mesh, const PartitionView& partition, std::span<const std::uint8_t> boxes,
              const Ask& ask);

  /// Of a point in a V_bnd voxel, of number `boundary`; none: a triangle may pass through its cell.
  std::optional<bool> find(const Int3& point, const Int3& voxel, std::uint32_t boundary) const;

  /// Calls for what find() reads of a voxel.
  void prefetch(std::uint32_t boundary) const {
    if (voxels_.empty()) return;
    __builtin_prefetch(&voxels_[boundary].touched);
    __builtin_prefetch(&voxels_[boundary].inside);
  }

  std::uint64_t bytes() const { return sizeof(Voxel) * voxels_.size(); }

  static constexpr int kCells = 8;  ///< of a voxel along an axis
  /// All cells of the grid: those that may hold a point inside, and those that hold nothing else. A brick
  /// each is a voxel. False: there are no cells, or too many voxels for such a table. Allocates.
  bool spread(const PartitionView& partition, BrickBits& may, BrickBits& all) const;

 private:
  /// Of a voxel, a bit a cell, x + 8 y + 64 z.
  struct Voxel {
    BrickBits::Block touched{};  ///< by a triangle, or by what an edge that does not cancel hides
    BrickBits::Block inside{};
  };

  Int3 origin_{0};
  std::int32_t size_ = 0;      ///< of a voxel, steps
  double per_cell_ = 0;        ///< cells a step
  std::vector<Voxel> voxels_;  ///< by V_bnd voxel; empty: there are no cells
};

inline std::optional<bool> InsideCells::find(const Int3& point, const Int3& voxel,
                                             std::uint32_t boundary) const {
  if (voxels_.empty()) return std::nullopt;
  std::uint32_t bit = 0;
  for (int k = 2; k >= 0; --k)
    bit = bit << 3 | static_cast<std::uint32_t>((point[k] - origin_[k] - size_ * voxel[k]) *
                                                per_cell_);  // below 8: a step is more than a double rounds
  const Voxel& cells = voxels_[boundary];
  if ((cells.touched[bit >> 6] >> (bit & 63) & 1) != 0) return std::nullopt;
  return (cells.inside[bit >> 6] >> (bit & 63) & 1) != 0;
}

}  // namespace palpate
