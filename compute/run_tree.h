#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/turned_boxes.h"
#include "model/lattice_mesh.h"

namespace palpate {

/// Boxes of a tool's runs of eight triangles, of eight runs, and so on, in its lattice frame: 3.5 bytes a triangle. What has collapsed is in none.
class RunTree {
 public:
  /// `order`: ids of the tool's triangles by place; it outlives this. Allocates.
  RunTree(const LatticeMesh& tool, std::span<const std::uint32_t> order);
  std::span<const std::uint32_t> order() const { return order_; }

  /// Calls take(run) for every run that which(ranges) names with each node above it, until take() returns false. which() tells, a bit each, which of
  /// eight nodes it wants, by the voxels that their turned boxes meet (voxels_of()); what meets none must not be among them.
  template <class Which, class Take>
  void descend(const VoxelTurn& turn, Which&& which, Take&& take) const {
    struct Open {
      std::uint32_t level, group;
    };
    std::array<Open, kEight * 12> open;   // 8^12 runs are more than a mesh can have; a level leaves at most eight groups waiting
    std::size_t count = 0;
    open[count++] = {static_cast<std::uint32_t>(levels_.size() - 1), 0};
    EightRanges ranges;
    while (count != 0) {
      const Open next = open[--count];
      voxels_of(turn, levels_[next.level][next.group], ranges);
      for (unsigned left = which(ranges); left != 0; left &= left - 1) {
        const std::uint32_t node = static_cast<std::uint32_t>(kEight) * next.group + static_cast<std::uint32_t>(std::countr_zero(left));
        if (next.level != 0)
          open[count++] = {next.level - 1, node};
        else if (!take(node))
          return;
      }
    }
  }

 private:
  std::span<const std::uint32_t> order_;
  std::vector<std::vector<EightBoxes>> levels_;   // of runs first; the last level is one group
};

}  // namespace palpate
