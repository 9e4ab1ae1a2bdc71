#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/scene/partition_lookup.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// What the straight way from a point of a V_bnd voxel to the voxel's middle crosses, of what the voxel lists
/// and what bounds a solid. As the way's end is known beforehand, a crossing is four signs of linear
/// functions of the point, in single precision, eight triangles at a time (docs/EXACTNESS.md section 9). Any
/// number of threads; only the constructor allocates.
class MiddleCrossings {
 public:
  static constexpr std::size_t kEight = 8;
  static constexpr float kUnsure = 0x1p-20F;  ///< of a value, where all that is summed is below 3
  /// Of eight triangles, all of them positive where the way crosses: the place beyond the plane, seen from
  /// the middle, and within each edge, as functions of the point's way from the middle.
  struct Rows {
    float plane[3][kEight], offset[kEight], edge[3][3][kEight];
    std::int32_t way[kEight];  ///< what it counts: the sign of such a crossing; 0: nobody
  };
  struct Net {
    std::int32_t crossed;  ///< Σ of the signs
    bool unsure;           ///< ask the integers
  };

  MiddleCrossings() = default;
  /// Of a partition with very long lists altogether nothing is kept.
  MiddleCrossings(const LatticeMesh& mesh, const PartitionView& partition);

  bool empty() const { return begin_.empty(); }
  /// `from_middle`: the point's way from the middle of the voxel of number `boundary`, in which it lies.
  Net crossed(const Int3& from_middle, std::uint32_t boundary) const;
  /// Calls for what crossed() reads first of a voxel.
  void prefetch(std::uint32_t boundary) const {
    if (empty()) return;
    const char* at = reinterpret_cast<const char*>(rows_.data() + begin_[boundary]);
    for (std::size_t line = 0; line < sizeof(Rows); line += 64) __builtin_prefetch(at + line);
  }
  std::uint64_t bytes() const { return sizeof(Rows) * rows_.size() + 4 * begin_.size(); }

 private:
  std::vector<std::uint32_t> begin_;  ///< by V_bnd voxel, and one more: its first rows
  std::vector<Rows> rows_;
};

}  // namespace palpate
