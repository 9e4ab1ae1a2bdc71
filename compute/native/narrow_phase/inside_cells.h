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

}  // namespace palpate
