#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "compute/native/broad_phase/turned_boxes.h"
#include "model/bytes_of.h"
#include "model/lattice/lattice_mesh.h"

namespace palpate {

/// Boxes of a tool's runs of eight triangles, of eight runs, and so on, in its lattice frame: 3.5 bytes a
/// triangle. What has collapsed is in none.
class RunTree {
 public:
  /// `order`: ids of the tool's triangles by place; it outlives this. Allocates.
  RunTree(const LatticeMesh& tool, std::span<const std::uint32_t> order);
  std::span<const std::uint32_t> order() const { return order_; }
  std::uint64_t bytes() const {
    std::uint64_t sum = bytes_of(levels_);
    for (const auto& level : levels_) sum += bytes_of(level);
    return sum;
  }

  /// Eight nodes of a level, or eight runs (level 0).
  struct Group {
    std::uint32_t level, number;
  };

  Group root() const { return {static_cast<std::uint32_t>(levels_.size() - 1), 0}; }

  /// Fills `out` with groups from which descents find what one from the root finds, and returns how many:
  /// from one, the root, to `out.size()`, at least kEight. `which` as in descend(), of whose work this is the
  /// beginning.
  template <class Which>
  std::size_t divide(const VoxelTurn& turn, Which&& which, std::span<Group> out) const {
    std::size_t count = 1;
    out[0] = root();
    EightRanges ranges;
    while (count != 0 && out[0].level != 0 && count * kEight <= out.size()) {  // all are of one level
      std::size_t below = out.size();  // the next level's, from the end on: behind what is still to be read
      for (std::size_t i = count; i-- > 0;) {
        const Group group = out[i];
        voxels_of(turn, levels_[group.level][group.number], ranges);
        for (unsigned left = which(ranges); left != 0; left &= left - 1)
          out[--below] = {group.level - 1, static_cast<std::uint32_t>(kEight) * group.number +
                                               static_cast<std::uint32_t>(std::countr_zero(left))};
      }
      std::copy(out.begin() + static_cast<std::ptrdiff_t>(below), out.end(), out.begin());
      count = out.size() - below;
    }
    return count;
  }

  /// Calls take(run) for every run below `from` that which(ranges) names with each node above it, until
  /// take() returns false. which() tells, a bit each, which of eight nodes it wants, by the voxels that their
  /// turned boxes meet (voxels_of()); what meets none must not be among them. Below a node of whose voxels
  /// whole(range) holds it is not asked again: take_whole(first, end) has all its runs, and ends as take()
  /// does.
  template <class Which, class Take, class Whole, class TakeWhole>
  void descend(const VoxelTurn& turn, const Group& from, Which&& which, Take&& take, Whole&& whole,
               TakeWhole&& take_whole) const {
    std::array<Group, kEight * 12>
        open;  // 8^12 runs are more than a mesh can have; a level leaves at most eight groups waiting
    std::size_t count = 0;
    open[count++] = from;
    EightRanges ranges;
    while (count != 0) {
      const Group next = open[--count];
      voxels_of(turn, levels_[next.level][next.number], ranges);
      for (unsigned left = which(ranges); left != 0; left &= left - 1) {
        const auto i = static_cast<std::uint32_t>(std::countr_zero(left));
        const std::uint32_t node = static_cast<std::uint32_t>(kEight) * next.number + i;
        if (whole(ranges.range(i))) {
          const std::size_t runs = std::size_t{1} << 3 * next.level,
                            all = (order_.size() + kEight - 1) / kEight;
          if (!take_whole(node * runs, std::min((node + 1) * runs, all))) return;
        } else if (next.level != 0)
          open[count++] = {next.level - 1, node};
        else if (!take(node))
          return;
      }
    }
  }

 private:
  std::span<const std::uint32_t> order_;
  std::vector<std::vector<EightBoxes>> levels_;  // of runs first; the last level is one group
};

}  // namespace palpate
