#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

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
    if (octants_.empty()) return;
    __builtin_prefetch(&octants_[8 * std::size_t{boundary}]);
    __builtin_prefetch(&octants_[8 * std::size_t{boundary} + 4]);
  }

 private:
  static constexpr int kSide = 4;  ///< cells of an octant of a voxel along an axis
  /// A bit a cell, x + 4 y + 16 z.
  struct Octant {
    std::uint64_t touched =
        0;  ///< by a triangle; all of them where the octant has an edge that does not cancel
    std::uint64_t inside = 0;
  };

  Int3 origin_{0};
  std::int32_t size_ = 0;        ///< of a voxel, steps
  double per_cell_ = 0;          ///< cells a step
  std::vector<Octant> octants_;  ///< eight a V_bnd voxel; empty: there are no cells
};

inline std::optional<bool> InsideCells::find(const Int3& point, const Int3& voxel,
                                             std::uint32_t boundary) const {
  if (octants_.empty()) return std::nullopt;
  std::uint32_t octant = 0, bit = 0;
  for (int k = 2; k >= 0; --k) {
    const auto cell = static_cast<std::uint32_t>((point[k] - origin_[k] - size_ * voxel[k]) *
                                                 per_cell_);  // below 8: a step is more than a double rounds
    octant = octant << 1 | cell / kSide;
    bit = bit << 2 | cell % kSide;
  }
  const Octant& cells = octants_[8 * std::size_t{boundary} + octant];
  if ((cells.touched >> bit & 1) != 0) return std::nullopt;
  return (cells.inside >> bit & 1) != 0;
}

}  // namespace palpate
